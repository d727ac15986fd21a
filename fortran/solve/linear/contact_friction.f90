!> One increment of contact with friction on the condensed equations: points from the rows and the
!> history, the solve; lopin_friction_history keeps what it leaves, lopin_friction_report says what
!> is odd.
module lopin_contact_friction
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_friction, only : friction_type, is_regularised, reads_speed
   use lopin_active_set, only : outcome
   use lopin_pair_friction, only : friction_in_step
   use lopin_surface_material, only : slave_yields
   use lopin_friction_rows, only : friction_points_type
   use lopin_friction_set, only : solve_friction, friction_result_type, friction_controls_type
   use lopin_friction_touch, only : touching
   use lopin_friction_history, only : remember
   use lopin_friction_report, only : report_elastic_slip, warn_of_wedging, warn_of_tension, explain
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: slides_with_friction, contact_with_friction, start_speed, renew_speed

   !> Elastic slip of penalty pairs that the deck leaves open, beside the facet (frozen).
   real(wp), parameter :: default_slip = 5.0e-3_wp

contains

   !> Some pair has rows along its tangents.
   pure logical function slides_with_friction(scene) result(slides)
      type(scene_type), intent(in) :: scene
      slides = scene%rows%nsolved > scene%rows%nnormal
   end function slides_with_friction

   !> Forces of all rows for the gaps, condensed loads and loads on floating motions given.
   subroutine contact_with_friction(scene, model, gap, load, moving, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), load(:), moving(:)
      type(error_type), allocatable, intent(out) :: error
      type(friction_points_type) :: points
      type(friction_result_type) :: friction

      call solve_points(scene, model, gap, load, moving, scene%again, points, friction)
      if (scene%answer%outcome /= outcome%solved .and. scene%friction%speed_of_trial &
         & .and. any(reads_speed(points%law))) then
         ! A bound that falls more steeply than the bodies are stiff has several answers.
         scene%friction%speed_of_trial = .false.
         call solve_points(scene, model, gap, load, moving, .false., points, friction)
      end if
      call explain(scene, model, points, friction, moving, error)
      if (allocated(error)) return
      call remember(scene, points, friction)
      call report_elastic_slip(scene, model, points)
      call warn_of_wedging(scene, model, points, friction)
      call warn_of_tension(scene, model, points)
   end subroutine contact_with_friction

   !> Forces of all rows from those accepted last, or of the last answer; the points they are of.
   subroutine solve_points(scene, model, gap, load, moving, again, points, friction)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), load(:), moving(:)
      logical, intent(in) :: again             !! from the last answer
      type(friction_points_type), intent(out) :: points
      type(friction_result_type), intent(out) :: friction
      type(friction_controls_type) :: controls

      call new_points(scene, model, points)
      if (again) then
         controls%predict = .false.
      else if (allocated(scene%accepted%friction%force)) then
         scene%answer%force = scene%accepted%friction%force
         scene%answer%gap = scene%accepted%friction%gap
         scene%answer%q = scene%accepted%friction%q
      else
         if (allocated(scene%answer%force)) deallocate (scene%answer%force)
      end if
      call solve_friction(scene%problem, points, gap, load, moving, scene%answer, friction, &
         & controls)
      scene%counter%iterations = scene%counter%iterations + scene%answer%iterations
      scene%counter%augmentations = scene%counter%augmentations + scene%answer%augmentations
   end subroutine solve_points

   !> The speed that decaying friction reads begins with that of the accepted increment.
   subroutine start_speed(scene)
      type(scene_type), intent(inout) :: scene
      scene%friction%speed = scene%accepted%friction%speed
      scene%friction%speed_of_trial = .true.
   end subroutine start_speed

   !> Speeds of slip for the next iteration, if laws read those; `change` is how far they moved,
   !> beside the largest: 0 where no law reads them.
   subroutine renew_speed(scene, model, change)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: change
      type(friction_type) :: law
      integer :: pair
      logical :: decays

      change = 0.0_wp
      decays = .false.
      if (scene%friction%speed_of_trial) return
      do pair = 1, size(model%pair)
         law = friction_in_step(model, model%pair(pair)%interaction, scene%step)
         decays = decays .or. reads_speed(law)
      end do
      if (.not. decays) return
      associate (s => scene%friction, trial => scene%trial%friction)
         change = maxval(abs(trial%speed - s%speed))/max(maxval(trial%speed), tiny(1.0_wp))
         s%speed = trial%speed
      end associate
   end subroutine renew_speed

   !> Points of the pairs with friction, with what they keep from the last accepted increment.
   subroutine new_points(scene, model, points)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(out) :: points
      type(friction_type) :: law
      integer :: n, nt, pair, row, k, i, d

      n = count(scene%rows%tangent > 0)
      nt = model%mesh%ndim - 1
      points%n = n
      points%nt = nt
      allocate (points%normal(n), points%tangent(n), points%law(n), points%at(n))
      allocate (points%weight(n), points%stiffness(n), points%elastic_slip(n), points%open(n), &
         & source=0.0_wp)
      allocate (points%traction(nt, n), points%start(nt, n), points%anchor(nt, n), &
         & points%elastic(nt, n), points%way(nt, n), source=0.0_wp)
      allocate (points%augmented(n), source=.false.)
      k = 0
      do pair = 1, size(model%pair)
         law = friction_in_step(model, model%pair(pair)%interaction, scene%step)
         do row = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
            if (scene%rows%tangent(row) == 0) cycle
            k = k + 1
            i = scene%rows%point(row)
            points%normal(k) = row
            points%tangent(k) = scene%rows%tangent(row)
            points%law(k) = law
            points%weight(k) = scene%points%weight(i)
            call elastic_stick(scene, model, pair, row, points, k)
            points%open(k) = scene%rows%gap0(row) + displaced(scene, row)
            if (points%open(k) <= touching*scene%points%size(i)) points%open(k) = 0.0_wp
            points%at(k)%dt = scene%newton%dt
            points%at(k)%held = scene%rows%bilateral(row)
            points%at(k)%mises = scene%friction%mises(i)
            points%at(k)%speed = scene%friction%speed(i)
            points%at(k)%of_trial = scene%friction%speed_of_trial
            do d = 1, nt
               associate (t => scene%rows%direction(:, points%tangent(k) + d - 1))
                  points%traction(d, k) = dot_product(t, scene%accepted%friction%traction(:, i))
                  points%anchor(d, k) = dot_product(t, scene%accepted%friction%anchor(:, i))
                  points%elastic(d, k) = dot_product(t, scene%accepted%friction%elastic(:, i))
                  points%way(d, k) = dot_product(t, scene%accepted%friction%slid(:, i))
               end associate
               points%start(d, k) = displaced(scene, points%tangent(k) + d - 1)
            end do
            if (points%augmented(k)) points%elastic(:, k) = -points%traction(:, k)/&
               & points%stiffness(k)
         end do
      end do
      call set_yield(scene, model, points)
   end subroutine new_points

   !> What the last accepted displacements do to the gap of a row [length].
   pure real(wp) function displaced(scene, row)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: row
      integer :: j

      displaced = 0.0_wp
      do j = scene%rows%first(row), scene%rows%first(row + 1) - 1
         displaced = displaced + scene%rows%coefficient(j)*scene%accepted%motion%u( &
            & scene%rows%dof(j))
      end do
   end function displaced

   !> Exact stick unless the deck gives an elastic slip or the pair is a penalty pair.
   subroutine elastic_stick(scene, model, pair, row, points, k)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, row, k
      type(friction_points_type), intent(inout) :: points

      associate (law => points%law(k), method => &
         & model%interaction(model%pair(pair)%interaction)%method, &
         & facet => scene%points%size(scene%rows%point(row)))
         if (law%exact_stick .or. is_regularised(law)) return
         points%augmented(k) = method%updates() .and. .not. max(law%elastic_slip, &
            & law%slip_tolerance, law%stick_slope) > 0.0_wp
         if (law%stick_slope > 0.0_wp) then
            points%stiffness(k) = law%stick_slope*points%weight(k)
         else if (points%augmented(k)) then
            points%stiffness(k) = scene%problem%alpha(row)
         else if (law%elastic_slip > 0.0_wp) then
            points%elastic_slip(k) = law%elastic_slip
         else if (law%slip_tolerance > 0.0_wp) then
            points%elastic_slip(k) = law%slip_tolerance*facet
         else if (.not. method%is_exact()) then
            points%elastic_slip(k) = default_slip*facet
         end if
      end associate
   end subroutine elastic_stick

   !> Yield stress behind the slave at each point.
   subroutine set_yield(scene, model, points)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(inout) :: points
      real(wp) :: yield(model%mesh%nnode)
      integer :: k, pair, last

      last = 0
      do k = 1, points%n
         associate (i => scene%rows%point(points%normal(k)))
            pair = scene%points%pair(i)
            if (pair /= last) call slave_yields(model, pair, yield)
            last = pair
            points%at(k)%yield = yield(scene%points%node(i))
         end associate
      end do
   end subroutine set_yield

end module lopin_contact_friction
