!> One increment of contact with friction on the condensed equations: points from the rows and the
!> history, the solve, the history that it leaves.
module lopin_contact_friction
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, method_of
   use lopin_friction, only : friction_type, is_regularised, by_rate, friction_radius, &
      & has_friction, drag_limit, reads_speed, return_to_disc
   use lopin_contact_rows, only : friction_in_step
   use lopin_surface_material, only : slave_yields
   use lopin_active_set, only : outcome
   use lopin_friction_rows, only : friction_points_type, elastic_compliance
   use lopin_friction_limits, only : find_wedging
   use lopin_friction_set, only : solve_friction, friction_result_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: slides_with_friction, contact_with_friction, start_speed, renew_speed

   !> Elastic slip of penalty pairs that the deck leaves open, beside the facet (frozen).
   real(wp), parameter :: default_slip = 5.0e-3_wp
   !> Work of a force over this share of a facet is rounding.
   real(wp), parameter :: rounding = 1.0e-14_wp

contains

   !> Some pair has rows along its tangents.
   pure logical function slides_with_friction(scene) result(slides)
      type(scene_type), intent(in) :: scene
      slides = scene%rows%n > scene%rows%nnormal
   end function slides_with_friction

   !> Forces of all rows for the gaps, condensed loads and loads on floating motions given.
   subroutine contact_with_friction(scene, model, gap, load, moving, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), load(:), moving(:)
      type(error_type), allocatable, intent(out) :: error
      type(friction_points_type) :: points
      type(friction_result_type) :: friction

      call new_points(scene, model, points)
      if (allocated(scene%friction%accepted%force)) then
         scene%answer%force = scene%friction%accepted%force
         scene%answer%gap = scene%friction%accepted%gap
         scene%answer%q = scene%friction%accepted%q
      else
         if (allocated(scene%answer%force)) deallocate (scene%answer%force)
      end if
      call solve_friction(scene%problem, points, gap, load, moving, scene%answer, friction)
      scene%counter%iterations = scene%counter%iterations + scene%answer%iterations
      scene%counter%augmentations = scene%counter%augmentations + scene%answer%augmentations
      call explain(scene, model, points, friction, error)
      if (allocated(error)) return
      call remember(scene, points, friction)
      call tell_elastic_slip(scene, model, points)
      call warn_of_wedging(scene, model, points, friction)
      call warn_of_tension(scene, model, points)
   end subroutine contact_with_friction

   !> The speed that decaying friction reads begins with that of the accepted increment.
   subroutine start_speed(scene)
      type(scene_type), intent(inout) :: scene
      scene%friction%speed = scene%friction%accepted%speed
   end subroutine start_speed

   !> Speeds of slip for the next iteration; `change` is how far they moved, beside the largest: 0
   !> where no law reads them.
   subroutine renew_speed(scene, model, change)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: change
      type(friction_type) :: law
      integer :: pair
      logical :: decays

      change = 0.0_wp
      decays = .false.
      do pair = 1, size(model%pair)
         law = friction_in_step(model, model%pair(pair)%interaction, scene%step)
         decays = decays .or. reads_speed(law)
      end do
      if (.not. decays) return
      associate (s => scene%friction)
         change = maxval(abs(s%trial%speed - s%speed))/max(maxval(s%trial%speed), tiny(1.0_wp))
         s%speed = s%trial%speed
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
      allocate (points%weight(n), points%stiffness(n), points%elastic_slip(n), source=0.0_wp)
      allocate (points%traction(nt, n), points%start(nt, n), points%anchor(nt, n), &
         & points%elastic(nt, n), source=0.0_wp)
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
            points%at(k)%dt = scene%finite%dt
            points%at(k)%held = scene%rows%bilateral(row)
            points%at(k)%mises = scene%friction%mises(i)
            points%at(k)%speed = scene%friction%speed(i)
            do d = 1, nt
               associate (t => scene%rows%direction(:, points%tangent(k) + d - 1))
                  points%traction(d, k) = dot_product(t, scene%friction%accepted%traction(:, i))
                  points%anchor(d, k) = dot_product(t, scene%friction%accepted%anchor(:, i))
                  points%elastic(d, k) = dot_product(t, scene%friction%accepted%elastic(:, i))
               end associate
               points%start(d, k) = displaced(scene, points%tangent(k) + d - 1)
            end do
            if (points%augmented(k)) points%elastic(:, k) = -points%traction(:, k)/&
               & points%stiffness(k)
         end do
      end do
      call set_yield(scene, model, points)
   end subroutine new_points

   !> Relative displacement along a tangential row at the last accepted increment.
   pure real(wp) function displaced(scene, row)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: row
      integer :: j

      displaced = 0.0_wp
      do j = scene%rows%first(row), scene%rows%first(row + 1) - 1
         displaced = displaced + scene%rows%coefficient(j)*scene%accepted(scene%rows%dof(j))
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
         points%augmented(k) = method == method_of%augmented .and. .not. law%elastic_slip > 0.0_wp &
            & .and. .not. law%slip_tolerance > 0.0_wp
         if (law%stick_slope > 0.0_wp) then
            points%stiffness(k) = law%stick_slope*points%weight(k)
         else if (points%augmented(k)) then
            points%stiffness(k) = scene%problem%alpha(row)
         else if (law%elastic_slip > 0.0_wp) then
            points%elastic_slip(k) = law%elastic_slip
         else if (law%slip_tolerance > 0.0_wp) then
            points%elastic_slip(k) = law%slip_tolerance*facet
         else if (method == method_of%penalty .or. method == method_of%perturbed) then
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

   !> The history that the answer leaves, as a trial, and the tests of friction.
   subroutine remember(scene, points, friction)
      type(scene_type), intent(inout) :: scene
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      real(wp) :: slip(3), slid(points%nt), lost(points%nt), elastic(points%nt), done, radius, slope, &
         & press, force(3)
      real(wp) :: most_work, most_bound, excess
      integer :: k, i

      associate (s => scene%friction, old => scene%friction%accepted, new => scene%friction%trial)
         new = old
         new%force = scene%answer%force
         new%gap = scene%answer%gap
         new%q = scene%answer%q
         s%slid = 0.0_wp
         s%least_work = 0.0_wp
         most_work = 0.0_wp
         most_bound = 0.0_wp
         excess = 0.0_wp
         do k = 1, points%n
            i = scene%rows%point(points%normal(k))
            new%status(i) = friction%status(k)
            new%traction(:, i) = 0.0_wp
            new%elastic(:, i) = 0.0_wp
            new%anchor(:, i) = 0.0_wp
            new%speed(i) = 0.0_wp
            if (friction%status(k) == 0) cycle
            associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
               press = max(scene%answer%force(points%normal(k)), 0.0_wp)
               elastic = -elastic_compliance(points, k, press)*scene%answer%force(from:to)
               slid = scene%answer%gap(from:to) - points%start(:, k)
               lost = 0.0_wp
               if (is_regularised(points%law(k))) then
                  lost = slid + points%anchor(:, k)
                  new%anchor(:, i) = global(drawn(points, k, lost))
                  ! What the anchor does not keep is dissipated; the rest is a spring's.
                  lost = lost - drawn(points, k, lost)
               else
                  ! Stick leaves no slip: its residual is rounding.
                  if (.not. points%augmented(k)) slid = slid - (elastic - points%elastic(:, k))
                  if (friction%status(k) == 1) slid = 0.0_wp
                  lost = slid
               end if
               force = global(scene%answer%force(from:to))
               slip = global(slid)
               new%elastic(:, i) = global(elastic)
            end associate
            new%traction(:, i) = force
            s%slid(:, i) = slip
            new%slip(:, i) = old%slip(:, i) + slip
            new%path(i) = old%path(i) + norm2(slip)
            new%speed(i) = norm2(slip)/points%at(k)%dt
            done = -dot_product(force, global(lost))
            new%work(i) = old%work(i) + done
            most_work = max(most_work, abs(done))
            ! Slips that are rounding do rounding's work.
            s%least_work = min(s%least_work, done + norm2(force)*maxval(friction%noise( &
               & points%tangent(k):points%tangent(k) + points%nt - 1)))
            call friction_radius(points%law(k), press/points%weight(k), points%at(k), radius, slope)
            if (radius < huge(1.0_wp)/max(points%weight(k), 1.0_wp)) then
               most_bound = max(most_bound, radius*points%weight(k))
               excess = max(excess, norm2(force) - radius*points%weight(k))
            end if
         end do
         ! Rounding of slips that add up to nothing is no dissipation.
         do k = 1, points%n
            associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
               most_work = max(most_work, 1.0e-3_wp*norm2(scene%answer%force(from:to)) &
                  & *norm2(scene%answer%gap(from:to)))
            end associate
         end do
         ! Slips and shears that are rounding do rounding's work.
         if (points%n > 0) most_work = max(most_work, rounding*maxval(abs(scene%answer%force)) &
            & *maxval(scene%points%size))
         if (most_work > 0.0_wp) s%least_work = s%least_work/most_work
         s%misfit = largest_misfit(scene, points, friction%noise)
         s%cone_excess = 0.0_wp
         if (most_bound > 0.0_wp) s%cone_excess = max(excess, 0.0_wp)/most_bound
      end associate

   contains

      !> A tangential vector of point k in global axes.
      function global(t) result(v)
         real(wp), intent(in) :: t(:)
         real(wp) :: v(3)
         integer :: d

         v = 0.0_wp
         do d = 1, size(t)
            v = v + t(d)*scene%rows%direction(:, points%tangent(k) + d - 1)
         end do
      end function global
   end subroutine remember

   !> How far the tractions are from what their slips ask for, point by point, beside the largest
   !> force: stick that slips, slip that is not along its traction.
   real(wp) function largest_misfit(scene, points, noise) result(worst)
      type(scene_type), intent(in) :: scene
      type(friction_points_type), intent(in) :: points
      real(wp), intent(in) :: noise(:)             !! (nrow) of the gaps [length]
      real(wp) :: press, stiffness, slip(points%nt), q(points%nt), bound, slope_q, slope_p, w, size_
      integer :: k
      logical :: slips

      worst = 0.0_wp
      size_ = maxval(abs(scene%answer%force))
      if (.not. size_ > 0.0_wp .or. .not. allocated(scene%problem%s)) return
      do k = 1, points%n
         if (is_regularised(points%law(k))) cycle
         w = points%weight(k)
         associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
            press = max(scene%answer%force(points%normal(k)), 0.0_wp)
            if (.not. press > 0.0_wp .or. .not. scene%problem%s(from, from) > 0.0_wp) cycle
            stiffness = 1.0_wp/scene%problem%s(from, from)
            slip = scene%answer%gap(from:to) - points%start(:, k) + points%elastic(:, k) &
               & + elastic_compliance(points, k, press)*scene%answer%force(from:to)
            q = scene%answer%force(from:to) - stiffness*slip
            call return_to_disc(points%law(k), norm2(q)/w, stiffness/w, press/w, points%at(k), &
               & bound, slope_q, slope_p, slips)
            if (norm2(q) > 0.0_wp) q = q*(bound*w/norm2(q))
            worst = max(worst, norm2(scene%answer%force(from:to) - q) &
               & - stiffness*maxval(noise(from:to)))
         end associate
      end do
      worst = worst/size_
   end function largest_misfit

   !> Slip from the anchor after the anchor has followed.
   function drawn(points, k, slip) result(left)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: slip(:)
      real(wp) :: left(size(slip)), limit

      left = slip
      if (by_rate(points%law(k))) left = 0.0_wp
      limit = drag_limit(points%law(k))
      if (norm2(left) > limit) left = left*(limit/norm2(left))
   end function drawn

   !> The elastic slip of penalty pairs, where it was not given, is said once.
   subroutine tell_elastic_slip(scene, model, points)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer :: k, i, pair

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'N0520') return
      end do
      do k = 1, points%n
         associate (law => points%law(k))
            if (.not. points%elastic_slip(k) > 0.0_wp) cycle
            if (law%elastic_slip > 0.0_wp .or. law%slip_tolerance > 0.0_wp) cycle
         end associate
         pair = scene%points%pair(scene%rows%point(points%normal(k)))
         call scene%log%say(severity%note, 'N0520', 'sticking points of this penalty pair give '// &
            & 'way by up to '//to_text(points%elastic_slip(k), 4)//', 0.5 % of a facet', &
            & model%pair(pair)%at, help='ELASTIC SLIP= on *FRICTION sets it; DIRECT sticks exactly')
         return
      end do
   end subroutine tell_elastic_slip

   !> Several answers may exist: said once a step, with the node and its critical coefficient.
   subroutine warn_of_wedging(scene, model, points, friction)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      real(wp) :: coefficient, critical
      integer :: worst

      if (scene%answer%outcome /= outcome%solved) return
      call find_wedging(scene%problem%s, points, friction%status, worst, coefficient, critical)
      if (worst > 0) then
         call warn(scene, model, 'W0520', 'frictional wedging: several equilibria are possible '// &
            & 'at the coefficient '//to_text(coefficient, 4)//'; node '//label_of(scene, model, &
            & points, worst)//' has one below '//to_text(critical, 6), 'the answer is the '// &
            & 'one that the load history leads to; smaller increments follow it more surely')
      else if (friction%sign_of_determinant < 0) then
         call warn(scene, model, 'W0520', 'frictional wedging: several equilibria are possible, '// &
            & 'because the slipping points together press themselves on', 'the answer is the '// &
            & 'one that the load history leads to; smaller increments follow it more surely')
      end if
   end subroutine warn_of_wedging

   !> What never separates may pull: friction then has no bound to read.
   subroutine warn_of_tension(scene, model, points)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer :: k

      do k = 1, points%n
         if (.not. points%at(k)%held .or. points%law(k)%rough) cycle
         if (.not. scene%answer%force(points%normal(k)) < 0.0_wp) cycle
         call warn(scene, model, 'W0521', 'node '//label_of(scene, model, points, k)// &
            & ' is pulled by NO SEPARATION: friction there is that of no pressure', &
            & 'TIED or ROUGH also hold along the face')
         return
      end do
   end subroutine warn_of_tension

   !> A warning of the run, once for each step.
   subroutine warn(scene, model, id, message, help)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: id, message, help
      integer :: i

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == id .and. scene%log%item(i)%at%line &
            & == model%step(scene%step)%at%line) return
      end do
      call scene%log%say(severity%warning, id, message, model%step(scene%step)%at, help=help)
   end subroutine warn

   function label_of(scene, model, points, k) result(label)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      character(len=:), allocatable :: label
      label = to_text(model%mesh%node_label(scene%points%node(scene%rows%point(points%normal(k)))))
   end function label_of

   !> What the outcome means, as an error.
   subroutine explain(scene, model, points, friction, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: nodes
      integer :: i

      select case (scene%answer%outcome)
      case (outcome%cycling)
         nodes = ''
         do i = 1, min(8, size(friction%changing))
            nodes = nodes//' '//label_of(scene, model, points, friction%changing(i))
         end do
         if (len(nodes) > 0) nodes = ', last at the nodes'//nodes
         call raise(error, error_code%not_converged, 'E0520', 'stick and slip cycle after '// &
            & to_text(scene%answer%iterations)//' iterations'//nodes, &
            & model%step(scene%step)%at, &
            & note='Newton, its damped tangent, single changes and fixed bounds were all tried', &
            & help='smaller increments, or a smaller coefficient of friction')
      case default
      end select
   end subroutine explain
end module lopin_contact_friction
