!> Messages at the end of a step: pairs that never touched, work lost, motions beyond small
!> displacements.
module lopin_after_step
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_methods, only : has_law
   use lopin_raise_penalty, only : chooses_elastic_slip
   use lopin_scene, only : scene_type
   use lopin_present_gaps, only : gap_of
   use lopin_repeated_messages, only : warn_once
   use lopin_coarse_rates, only : coarse_rates_type, measure_coarse_rates, tell_coarse_rates
   use lopin_hanging_facets, only : hanging_type, measure_hanging, tell_hanging
   use lopin_check_stretch, only : stretched_type, measure_stretch, check_stretch
   use lopin_eased_friction, only : tell_eased
   use lopin_narrow_friction, only : narrow_friction_type, measure_narrow_friction, &
      & tell_narrow_friction
   use lopin_narrow_tools, only : check_narrow_tools
   use lopin_narrow_masters, only : check_narrow_masters
   use lopin_passed_tools, only : check_passed_tools
   use lopin_undecided_ties, only : check_undecided_ties
   use lopin_small_displacements, only : excursion_type, measure_small_displacements, &
      & check_small_displacements, rotation_limit
   use lopin_contact_rows, only : joins_pair
   use lopin_neutral_motion, only : neutral_type, find_neutral_motion, tell_neutral_motion
   use lopin_needless_finite_path, only : finite_path_type, measure_finite_path, &
      & tell_needless_finite_path
   implicit none
   private
   public :: step_record_type, record_increment, check_step

   !> The elastic slip that penalty pairs choose, in facets; slips this many times it dwarf it.
   real(wp), parameter :: chosen_slip = 0.005_wp, slips = 20.0_wp
   !> Elastic slips below this share of what is allowed are rounding of scenes without shear.
   real(wp), parameter :: no_shear = 1.0e-6_wp
   !> Bounds of shear that lightly pressed points lack, beside all bounds.
   real(wp), parameter :: most_ramp = 0.02_wp
   !> Gaps below this share of the bodies are none.
   real(wp), parameter :: touching = 1.0e-9_wp

   !> What was seen so far.
   type :: step_record_type
      logical, allocatable :: closed(:)      !! (npair) at some increment
      real(wp), allocatable :: nearest(:)    !! (npair) smallest gap [length]
      type(excursion_type) :: strayed        !! beyond the theory of small displacements
      type(stretched_type) :: stretched      !! under NLGEOM
      real(wp), allocatable :: turned(:)     !! (nbody) largest rotation in the step [rad]
      real(wp) :: ramp = 0.0_wp              !! largest where bounds of friction are eased [-]
      type(coarse_rates_type) :: rates       !! of metal in long increments
      type(hanging_type) :: hanging          !! past edges
      type(neutral_type) :: neutral          !! motion that flow leaves open
      type(finite_path_type) :: finite_path  !! NLGEOM that no step called for
      type(narrow_friction_type) :: narrow   !! work where contact is narrower than facets
   contains
      procedure :: keep => keep_seen
   end type step_record_type

contains

   !> To a stream or back.
   subroutine keep_seen(self, stream)
      class(step_record_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%closed)
      call stream%pass(self%nearest)
      call self%strayed%keep(stream)
      call self%stretched%keep(stream)
      call stream%pass(self%turned)
      call stream%pass(self%ramp)
      call self%rates%keep(stream)
      call self%hanging%keep(stream)
      call self%neutral%keep(stream)
      call self%finite_path%keep(stream)
      call self%narrow%keep(stream)
   end subroutine keep_seen

   !> Look at an accepted increment.
   subroutine record_increment(self, scene, model, increment, ramp)
      type(step_record_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment         !! its number in the step
      real(wp), intent(in) :: ramp             !! share of bounds of shear that is lacking [-]
      integer :: body

      if (allocated(scene%trial%contact%eased)) self%ramp = max(self%ramp, ramp)
      call record_pairs(self, scene, model)
      call check_passed_tools(scene, model)
      if (scene%newton%in_use) call check_undecided_ties(scene, model)
      call measure_narrow_friction(self%narrow, scene, model)
      call measure_small_displacements(self%strayed, scene, model)
      call find_neutral_motion(self%neutral, scene, model)
      if (scene%newton%nlgeom) then
         call measure_stretch(self%stretched, scene, model)
         call measure_coarse_rates(self%rates, scene, increment)
         call measure_hanging(self%hanging, scene, model, increment)
         call measure_finite_path(self%finite_path, scene, model)
         return
      end if
      if (.not. allocated(self%turned)) allocate (self%turned(size(model%rigid_body)), &
         & source=0.0_wp)
      do body = 1, size(model%rigid_body)
         self%turned(body) = max(self%turned(body), turn_of(scene, model, body))
      end do
   end subroutine record_increment

   !> Rotation of a rigid body of nodes; 0 for other tools.
   pure real(wp) function turn_of(scene, model, body)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      real(wp) :: turn(3)
      integer :: k

      turn = 0.0_wp
      associate (rigid => model%rigid_body(body))
         do k = 4, 6
            if (size(rigid%node) == 0) exit
            if (scene%dofs%id(k, rigid%reference) > 0) turn(k - 3) = &
               & scene%trial%motion%u(scene%dofs%id(k, rigid%reference))
         end do
      end associate
      turn_of = norm2(turn)
   end function turn_of

   subroutine record_pairs(self, scene, model)
      type(step_record_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, i, row

      if (.not. allocated(self%closed)) then
         allocate (self%closed(size(model%pair)), source=.false.)
         allocate (self%nearest(size(model%pair)), source=huge(1.0_wp))
      end if
      if (scene%newton%in_use) then
         call record_nonlinear(self, scene)
         return
      end if
      do row = 1, scene%rows%n
         if (.not. joins_pair(scene%rows, row)) cycle
         pair = scene%points%pair(scene%rows%point(row))
         self%closed(pair) = self%closed(pair) .or. scene%rows%tied(row) &
            & .or. scene%answer%force(row) > 0.0_wp &
            & .or. (scene%answer%active(row) .and. .not. has_law(model, pair))
      end do
      do i = 1, scene%points%n
         pair = scene%points%pair(i)
         if (self%closed(pair) .or. scene%points%facet(i) == 0) cycle
         self%nearest(pair) = min(self%nearest(pair), gap_of(scene, model, i))
      end do
   end subroutine record_pairs

   subroutine record_nonlinear(self, scene)
      type(step_record_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      integer :: i

      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%facet(i) == 0) cycle
            self%closed(c%pair(i)) = self%closed(c%pair(i)) .or. c%status(i) > 0
            self%nearest(c%pair(i)) = min(self%nearest(c%pair(i)), c%opening(i))
         end do
      end associate
   end subroutine record_nonlinear

   !> Say at the end of a step what its answer cannot be trusted in, and after the last what never
   !> met.
   subroutine check_step(scene, model, seen, ramp, whole, taken)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(step_record_type), intent(inout) :: seen
      real(wp), intent(in) :: ramp             !! share of bounds of shear that is lacking [-]
      real(wp), intent(in) :: whole            !! work done so far [energy]
      real(wp), intent(in) :: taken            !! stored and spent in the bodies [energy]
      integer :: pair

      if (scene%step == size(model%step)) then
         do pair = 1, size(model%pair)
            if (seen%closed(pair) .or. .not. seen%nearest(pair) < huge(1.0_wp)) cycle
            call warn_of_gap(scene, model, pair, seen%nearest(pair))
         end do
         call tell_needless_finite_path(seen%finite_path, scene, model)
      end if
      call check_small_displacements(seen%strayed, scene, model)
      if (scene%newton%nlgeom) call check_stretch(seen%stretched, scene, model)
      if (.not. scene%newton%nlgeom) call check_rigid_bodies(scene, model, seen%turned)
      call check_narrow_tools(scene, model)
      call check_narrow_masters(scene, model, taken)
      call check_elastic_slip(scene, model)
      if (ramp > most_ramp) call tell_ramp(scene, model, ramp)
      call tell_eased(scene, model, seen%ramp)
      seen%ramp = 0.0_wp
      call tell_coarse_rates(seen%rates, scene, model)
      call tell_hanging(seen%hanging, scene, model)
      call tell_neutral_motion(seen%neutral, scene, model)
      call tell_narrow_friction(seen%narrow, scene, model, whole)
   end subroutine check_step

   !> Points that slip under so little pressure that their law has not its bound there.
   subroutine tell_ramp(scene, model, ramp)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: ramp             !! share of bounds of shear that is lacking [-]

      call warn_once(scene%log, 'W0327', 'points in contact are pressed so lightly at the end '// &
         & 'of step '//to_text(scene%step)//' that '//to_text(100.0_wp*ramp, 3)//' % of what '// &
         & 'their law of friction allows is left out', model%step(scene%step)%at, &
         & help='the bound rises with the pressure up to a tenth of it; COULOMB-OROWAN has a '// &
         & 'slope of your own')
   end subroutine tell_ramp

   !> A pair that never carried a force: it never met, or it touched only.
   subroutine warn_of_gap(scene, model, pair, nearest)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: nearest              !! smallest gap [length]
      character(len=:), allocatable :: text
      integer :: i

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'W0315' .and. scene%log%item(i)%at%line &
            & == model%pair(pair)%at%line .and. scene%log%item(i)%at%file &
            & == model%pair(pair)%at%file) return
      end do
      text = ') never closed; its smallest gap was '//to_text(nearest, 6)
      if (abs(nearest) <= touching*scene%bodies%length) &
         & text = ') never closed: it touched, and carried no force'
      associate (p => model%pair(pair))
         call warn_once(scene%log, 'W0314', 'pair ('//model%surface(p%slave)%name//', '// &
            & model%surface(p%master)%name//text, p%at, &
            & help='look at units and positions, and at what holds the bodies, if it was meant '// &
            & 'to touch')
      end associate
   end subroutine warn_of_gap

   !> The nodes of a rigid body follow its rotation linearly: on tangents, not on circles.
   subroutine check_rigid_bodies(scene, model, turned)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: turned(:)     !! (nbody) largest rotation in the step [rad]
      integer :: body

      do body = 1, size(model%rigid_body)
         associate (rigid => model%rigid_body(body), turn => turned(body))
            if (turn > rotation_limit) call warn_once(scene%log, 'W0513', 'rigid body '// &
               & rigid%name//' turns by '//to_text(turn, 3)//' rad, and its nodes follow on '// &
               & 'tangents instead of circles: the body swells by '// &
               & to_text(100.0_wp*(sqrt(1.0_wp + turn**2) - 1.0_wp), 3)//' %', rigid%at, &
               & help='prescribe the displacements of the nodes, or use an analytic or STL tool')
            turn = 0.0_wp
         end associate
      end do
   end subroutine check_rigid_bodies

   !> An elastic slip that was chosen must be small beside the slips that it stands in for.
   subroutine check_elastic_slip(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: facet
      integer :: point, pair

      if (scene%newton%in_use .or. .not. allocated(scene%trial%friction%path)) return
      do pair = 1, size(model%pair)
         if (.not. chooses_elastic_slip(model%interaction(model%pair(pair)%interaction))) cycle
         facet = 0.0_wp
         do point = scene%points%first(pair), scene%points%first(pair + 1) - 1
            facet = max(facet, scene%points%size(point))
         end do
         if (scene%points%first(pair + 1) == scene%points%first(pair)) cycle
         associate (path => scene%trial%friction%path(scene%points%first(pair): &
            & scene%points%first(pair + 1) - 1))
            if (maxval(path) > slips*chosen_slip*facet) cycle
            ! Where nothing shears, nothing gives way.
            if (.not. maxval(abs(scene%trial%friction%elastic(:, scene%points%first(pair): &
               & scene%points%first(pair + 1) - 1))) > no_shear*chosen_slip*facet) cycle
            call warn_once(scene%log, 'W0514', 'no node of '// &
               & model%surface(model%pair(pair)%slave)%name//' slips farther than '// &
               & to_text(maxval(path), 3)//', and sticking ones give way by up to '// &
               & to_text(chosen_slip*facet, 3)//' (0.5 % of a facet, chosen): the zones of '// &
               & 'stick and slip are blurred', model%pair(pair)%at, &
               & help='DIRECT sticks exactly; or give ELASTIC SLIP= on *FRICTION')
         end associate
      end do
   end subroutine check_elastic_slip
end module lopin_after_step
