!> Limits of the theory of small displacements: slips, rotations and strains beyond them.
!>
!> Every accepted increment is looked at, for what goes beyond a limit may come back before the step
!> ends; the end of the step says the worst.
module lopin_small_displacements
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_stream, only : stream_type
   use lopin_scene, only : scene_type
   use lopin_present_gaps, only : relative_motion
   use lopin_tool, only : foot_type, project_moved
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_repeated_messages, only : warn_once
   use lopin_mean_gradient, only : own_motion, gradient_of, find_reach, largest_gradients
   implicit none
   private
   public :: excursion_type, measure_small_displacements, check_small_displacements, &
      & pair_that_slid, turns

   !> Limits of small displacement: slip over facet, rotation [rad], strain [-].
   real(wp), parameter :: slip_limit = 0.25_wp, strain_limit = 0.05_wp
   real(wp), parameter, public :: rotation_limit = 0.05_wp
   !> Normals are parallel up to this.
   real(wp), parameter :: parallel = 1.0e-8_wp

   !> What went farthest beyond the limits so far in a step; places 0: nothing did.
   type :: excursion_type
      real(wp) :: slip = slip_limit            !! over facet [-]
      real(wp) :: rotation = rotation_limit    !! [rad]
      real(wp) :: strain = strain_limit        !! [-]
      integer :: slid = 0                      !! point
      integer :: turned = 0, strained = 0      !! elements
      !> (nelement) No gradient of an element is larger than this times how far its nodes move
      !> apart [1/length]; of the mesh, not of the step
      real(wp), allocatable :: reach(:)
   contains
      procedure :: keep => keep_strayed
      procedure, private :: clear
   end type excursion_type

contains

   !> To a stream or back.
   subroutine keep_strayed(self, stream)
      class(excursion_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%slip)
      call stream%pass(self%rotation)
      call stream%pass(self%strain)
      call stream%pass(self%slid)
      call stream%pass(self%turned)
      call stream%pass(self%strained)
   end subroutine keep_strayed

   !> As at the start of a step.
   subroutine clear(self)
      class(excursion_type), intent(inout) :: self
      real(wp), allocatable :: reach(:)

      call move_alloc(self%reach, reach)
      select type (self)
      type is (excursion_type)
         self = excursion_type()
      end select
      call move_alloc(reach, self%reach)
   end subroutine clear

   !> Look at an accepted increment.
   subroutine measure_small_displacements(self, scene, model)
      type(excursion_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: slip
      integer :: worst, pair

      if (.not. scene%newton%in_use) then
         ! Along a plane that cannot turn sliding changes nothing.
         call worst_slip(scene, model, [(.true., pair=1, size(model%pair))], worst, slip, &
            & held=.true.)
         if (worst > 0 .and. slip > self%slip) then
            self%slip = slip
            self%slid = worst
         end if
      end if
      if (.not. scene%newton%nlgeom) call check_elements(self, scene, model)
   end subroutine measure_small_displacements

   !> Say at the end of a step what its increments went beyond; the next begins anew.
   subroutine check_small_displacements(self, scene, model)
      type(excursion_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%slid > 0) call warn_of_slip(self, scene, model)
      call warn_of_elements(self, scene, model)
      call self%clear()
   end subroutine check_small_displacements

   !> Closed points that have slid far on their facet: the normal and the place are those of the
   !> start.
   subroutine warn_of_slip(self, scene, model)
      type(excursion_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      call warn_once(scene%log, 'W0505', 'node '// &
         & to_text(model%mesh%node_label(scene%points%node(self%slid)))// &
         & ' has slid by '//to_text(nint(100.0_wp*self%slip))//' % of its facet in step '// &
         & to_text(scene%step)// &
         & ': contact is followed where the node was at the start', &
         & model%pair(scene%points%pair(self%slid))%at, &
         & help='the pressure is moved by as much: judge the answer by this distance, or '// &
         & 'take *LOPIN, PATH=FINITE, which follows the slave')
   end subroutine warn_of_slip

   !> The pair without SMALL SLIDING whose points slid farther than the small theory bears; 0: none.
   integer function pair_that_slid(scene, model) result(pair)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: largest
      integer :: worst

      call worst_slip(scene, model, .not. model%pair%small_sliding, worst, largest, turning=.true.)
      pair = 0
      if (worst > 0) pair = scene%points%pair(worst)
   end function pair_that_slid

   !> The tool's normal where the point is now is not that where it was projected: along a plane
   !> sliding changes nothing.
   logical function turns(scene, model, point)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      type(rigid_motion_type) :: motion
      type(foot_type) :: foot
      real(wp) :: x(model%mesh%ndim), own(3), at(model%mesh%ndim), place(6)
      integer :: body, d

      turns = .true.
      d = model%mesh%ndim
      associate (pair => scene%points%pair(point))
         if (scene%points%tool(pair) == 0) return
         own = own_motion(scene, model, scene%points%node(point))
         x = model%mesh%x(:, scene%points%node(point)) + own(:d)
         body = scene%points%body(pair)
         place = 0.0_wp
         at = 0.0_wp
         if (body > 0) then
            place = scene%place(:, body)
            at = model%mesh%x(:, model%rigid_body(body)%reference)
         end if
         if (d == 2) call new_rigid_motion(motion, at, place(:2), place(6:6))
         if (d == 3) call new_rigid_motion(motion, at, place(:3), place(4:6))
         call project_moved(model%tool(scene%points%tool(pair))%shape, motion, x, foot)
         turns = dot_product(foot%normal(:d), scene%points%normal(:d, point)) < 1.0_wp - parallel
      end associate
   end function turns

   !> The tool of a point may turn under a pressure that has moved.
   pure logical function may_tilt(scene, model, point)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      integer :: k

      may_tilt = .false.
      associate (body => scene%points%body(scene%points%pair(point)))
         if (body == 0) return
         do k = 4, 6
            associate (id => scene%dofs%id(k, model%rigid_body(body)%reference))
               if (id > 0) may_tilt = may_tilt .or. scene%constraints%rule(id)%prescribed == 0
            end associate
         end do
      end associate
   end function may_tilt

   !> The closed point of the asked pairs that slid farthest beyond the limit; 0: none did.
   subroutine worst_slip(scene, model, asked, worst, largest, turning, held)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: asked(:)          !! (npair)
      integer, intent(out) :: worst
      real(wp), intent(out) :: largest         !! slip over facet
      logical, intent(in), optional :: turning !! only where the normal has changed
      logical, intent(in), optional :: held    !! not along planes that cannot turn
      real(wp) :: motion(3), slip
      integer :: row, point

      largest = slip_limit
      worst = 0
      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row) .or. .not. scene%answer%force(row) > 0.0_wp) cycle
         point = scene%rows%point(row)
         if (.not. asked(scene%points%pair(point))) cycle
         ! What a tool does itself is projected where it stands: there only the slave's own way
         ! counts.
         if (scene%points%tool(scene%points%pair(point)) > 0) then
            motion = own_motion(scene, model, scene%points%node(point))
         else
            motion = relative_motion(scene, model, point, since_projection=.false.)
         end if
         motion = motion &
            & - dot_product(motion, scene%points%normal(:, point))*scene%points%normal(:, point)
         slip = norm2(motion)/scene%points%size(point)
         if (slip <= largest) cycle
         if (present(turning)) then
            if (.not. turns(scene, model, point)) cycle
         else if (present(held)) then
            if (.not. may_tilt(scene, model, point)) then
               if (.not. turns(scene, model, point)) cycle
            end if
         end if
         largest = slip
         worst = point
      end do
   end subroutine worst_slip

   !> Rotations and strains of the elements, from the mean gradient of their nodes' displacements.
   subroutine check_elements(self, scene, model)
      type(excursion_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: rotation, strain, bound(model%mesh%nelement)
      integer :: e

      if (.not. allocated(self%reach)) call find_reach(model, self%reach)
      call largest_gradients(scene, model, self%reach, bound)
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         if (bound(e) < min(self%rotation, self%strain)) cycle
         call mean_gradient(scene, model, e, rotation, strain)
         if (rotation > self%rotation) then
            self%rotation = rotation
            self%turned = e
         end if
         if (strain > self%strain) then
            self%strain = strain
            self%strained = e
         end if
      end do
   end subroutine check_elements

   subroutine warn_of_elements(self, scene, model)
      type(excursion_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%turned > 0) call warn_once(scene%log, 'W0506', 'element '// &
         & to_text(model%mesh%element_label(self%turned))// &
         & ' turns by '//to_text(self%rotation, 3)// &
         & ' rad: rotations are taken as small (NLGEOM=NO)', &
         & model%step(scene%step)%at, &
         & help='a rotation t stretches by t^2/2; hold the motion if it is not meant')
      if (self%strained > 0) call warn_once(scene%log, 'W0507', 'element '// &
         & to_text(model%mesh%element_label(self%strained))// &
         & ' is strained by '//to_text(100.0_wp*self%strain, 3)// &
         & ' %: strains are taken as small (NLGEOM=NO)', &
         & model%step(scene%step)%at, &
         & help='look at units, loads and modulus; beyond 5 % the answer is linear in name only')
   end subroutine warn_of_elements

   subroutine mean_gradient(scene, model, e, rotation, strain)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(out) :: rotation            !! [rad]
      real(wp), intent(out) :: strain              !! largest component, shears halved [-]
      real(wp) :: h(3, 3)

      call gradient_of(scene, model, e, h)
      rotation = 0.5_wp*norm2([h(3, 2) - h(2, 3), h(1, 3) - h(3, 1), h(2, 1) - h(1, 2)])
      strain = maxval(abs(0.5_wp*(h + transpose(h))))
   end subroutine mean_gradient

end module lopin_small_displacements
