!> The history that an increment of friction leaves: tractions, slips, work; and the checks of it.
module lopin_friction_history
   use lopin_kinds, only : wp
   use lopin_friction, only : condition_type, is_regularised, by_rate, friction_radius, &
      & lost_at_touch
   use lopin_friction_return, only : drag_limit, return_to_disc, steepest_fall
   use lopin_contact_traction, only : regularised_energy
   use lopin_friction_rows, only : friction_points_type, elastic_compliance
   use lopin_friction_set, only : friction_result_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: remember

   !> A compliance below this share of the largest is rounding: an artificial support holds the row.
   real(wp), parameter :: rounded = 1.0e-12_wp

   type :: sums_type
      real(wp) :: slack = 0.0_wp               !! work of slips that are rounding [force*length]
      real(wp) :: most_bound = 0.0_wp          !! largest bound of the shear [force]
      real(wp) :: excess = 0.0_wp              !! largest force beyond its bound [force]
      real(wp) :: lost = 0.0_wp                !! what points lack of their bounds [force]
      real(wp) :: whole = 0.0_wp               !! their bounds [force]
   end type sums_type

contains

   !> The history that the answer leaves, as a trial, and the tests of friction.
   subroutine remember(scene, points, friction)
      type(scene_type), intent(inout) :: scene
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      type(sums_type) :: sums
      integer :: k

      associate (s => scene%friction, new => scene%trial%friction)
         new = scene%accepted%friction
         new%force = scene%answer%force
         new%gap = scene%answer%gap
         new%q = scene%answer%q
         s%slid = 0.0_wp
         s%touch = 0.0_wp
         s%stored = 0.0_wp
         s%gained = 0.0_wp
         s%slid_work = 0.0_wp
         do k = 1, points%n
            call remember_point(scene, points, friction, k, sums)
         end do
         ! Slips that are rounding do rounding's work.
         s%gained = min(s%gained + sums%slack, 0.0_wp)
         s%misfit = largest_misfit(scene, points, friction%noise)
         s%ramp = 0.0_wp
         if (sums%lost > 0.0_wp) s%ramp = sums%lost/sums%whole
         s%cone_excess = 0.0_wp
         if (sums%most_bound > 0.0_wp) s%cone_excess = max(sums%excess, 0.0_wp)/sums%most_bound
      end associate
   end subroutine remember

   !> One point: its traction, slip and work; and what it adds to the tests.
   subroutine remember_point(scene, points, friction, k, sums)
      type(scene_type), intent(inout) :: scene
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      integer, intent(in) :: k
      type(sums_type), intent(inout) :: sums
      real(wp) :: slip(3), lost(points%nt), done, radius, slope, press, force(3)
      type(condition_type) :: at
      integer :: i

      i = scene%rows%point(points%normal(k))
      associate (s => scene%friction, old => scene%accepted%friction, new => scene%trial%friction)
         new%status(i) = friction%status(k)
         new%traction(:, i) = 0.0_wp
         new%elastic(:, i) = 0.0_wp
         new%anchor(:, i) = 0.0_wp
         new%speed(i) = 0.0_wp
         new%slid(:, i) = 0.0_wp
         if (friction%status(k) == 0) return
         s%touch(i) = points%touch(k)
         press = max(scene%answer%force(points%normal(k)), 0.0_wp)
         call find_slip(scene, points, friction%status(k), k, slip, lost)
         force = global(scene, points, k, scene%answer%force( &
            & points%tangent(k):points%tangent(k) + points%nt - 1))
         new%traction(:, i) = force
         s%slid(:, i) = slip
         if (friction%status(k) == 2) new%slid(:, i) = slip
         new%slip(:, i) = old%slip(:, i) + slip
         new%path(i) = old%path(i) + norm2(slip)
         new%speed(i) = norm2(lost)/points%at(k)%dt
         at = points%at(k)
         if (at%of_trial) at%speed = new%speed(i)
         done = -dot_product(force, global(scene, points, k, lost))
         new%work(i) = old%work(i) + done
         new%mean_work(i) = old%mean_work(i) - 0.5_wp*dot_product(old%traction(:, i) + force, &
            & global(scene, points, k, lost))
         s%stored = s%stored + stored_energy(points, k, press, force, new%anchor(:, i))
         s%gained = s%gained + min(done, 0.0_wp)
         sums%slack = sums%slack + norm2(force)*maxval(friction%noise( &
            & points%tangent(k):points%tangent(k) + points%nt - 1))
         s%slid_work = s%slid_work + norm2(force)*norm2(lost)
         call friction_radius(points%law(k), press/points%weight(k), at, radius, slope)
         if (radius < huge(1.0_wp)/max(points%weight(k), 1.0_wp)) then
            sums%most_bound = max(sums%most_bound, radius*points%weight(k))
            sums%excess = max(sums%excess, norm2(force) - radius*points%weight(k))
         end if
      end associate
      call add_lost(points, k, friction%status(k), press/points%weight(k), norm2(slip), sums)
   end subroutine remember_point

   !> What the point lacks of its bound, and the bound.
   pure subroutine add_lost(points, k, status, pressure, slid, sums)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k, status
      real(wp), intent(in) :: pressure         !! [stress]
      real(wp), intent(in) :: slid             !! in the increment [length]
      type(sums_type), intent(inout) :: sums
      type(condition_type) :: at
      real(wp) :: lost, whole

      at = points%at(k)
      at%speed = slid/at%dt
      call lost_at_touch(points%law(k), pressure, at, lost, whole)
      if (status == 2) sums%lost = sums%lost + lost*points%weight(k)
      sums%whole = sums%whole + whole*points%weight(k)
   end subroutine add_lost

   !> Slip of the increment, and of it what is lost; elastic slip and anchor go into the trial.
   subroutine find_slip(scene, points, status, k, slip, lost)
      type(scene_type), intent(inout) :: scene
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: status, k
      real(wp), intent(out) :: slip(3)         !! in global axes [length]
      real(wp), intent(out) :: lost(:)         !! (nt) along the tangents [length]
      real(wp) :: slid(points%nt), elastic(points%nt), press

      press = max(scene%answer%force(points%normal(k)), 0.0_wp)
      associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1, &
         & i => scene%rows%point(points%normal(k)), new => scene%trial%friction)
         elastic = -elastic_compliance(points, k, press)*scene%answer%force(from:to)
         slid = scene%answer%gap(from:to) - points%start(:, k)
         if (is_regularised(points%law(k))) then
            lost = slid + points%anchor(:, k)
            new%anchor(:, i) = global(scene, points, k, drawn(points, k, lost))
            ! What the anchor does not keep is dissipated; the rest is a spring's.
            lost = lost - drawn(points, k, lost)
         else
            ! Stick leaves no slip: its residual is rounding.
            if (.not. points%augmented(k)) slid = slid - (elastic - points%elastic(:, k))
            if (status == 1) slid = 0.0_wp
            lost = slid
         end if
         slip = global(scene, points, k, slid)
         new%elastic(:, i) = global(scene, points, k, elastic)
      end associate
   end subroutine find_slip

   !> A tangential vector of point k in global axes.
   pure function global(scene, points, k, t) result(v)
      type(scene_type), intent(in) :: scene
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: t(:)             !! (nt)
      real(wp) :: v(3)
      integer :: d

      v = 0.0_wp
      do d = 1, size(t)
         v = v + t(d)*scene%rows%direction(:, points%tangent(k) + d - 1)
      end do
   end function global

   !> Energy that a point gives back when its traction goes: of elastic stick, or of a regularised
   !> law between its anchor and the slip that it keeps [force*length].
   real(wp) function stored_energy(points, k, press, force, kept) result(energy)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: press, force(3)      !! [force]
      real(wp), intent(in) :: kept(3)              !! slip from the anchor [length]

      energy = 0.0_wp
      if (is_regularised(points%law(k))) then
         energy = points%weight(k)*regularised_energy(points%law(k), norm2(kept), &
            & press/points%weight(k), points%at(k))
      else if (.not. points%augmented(k)) then
         energy = 0.5_wp*elastic_compliance(points, k, press)*dot_product(force, force)
      end if
   end function stored_energy

   !> How far the tractions are from what their slips ask for, point by point, beside the largest
   !> force: stick that slips, slip that is not along its traction.
   real(wp) function largest_misfit(scene, points, noise) result(worst)
      type(scene_type), intent(in) :: scene
      type(friction_points_type), intent(in) :: points
      real(wp), intent(in) :: noise(:)             !! (nrow) of the gaps [length]
      real(wp) :: press, stiffness, slip(points%nt), q(points%nt), bound, slope_q, slope_p, w, &
         & size_, softest
      integer :: k

      worst = 0.0_wp
      size_ = maxval(abs(scene%answer%force))
      if (.not. size_ > 0.0_wp .or. .not. allocated(scene%problem%s)) return
      softest = maxval([(scene%problem%s(k, k), k=1, size(scene%problem%s, 1))])
      do k = 1, points%n
         if (is_regularised(points%law(k))) cycle
         w = points%weight(k)
         associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
            press = max(scene%answer%force(points%normal(k)), 0.0_wp)
            if (.not. press > 0.0_wp) cycle
            if (.not. scene%problem%s(from, from) > rounded*softest) cycle
            stiffness = max(1.0_wp/scene%problem%s(from, from), 2.0_wp*w*steepest_fall( &
               & points%law(k), press/w, points%at(k)))
            slip = scene%answer%gap(from:to) - points%start(:, k) + points%elastic(:, k) &
               & + elastic_compliance(points, k, press)*scene%answer%force(from:to)
            q = scene%answer%force(from:to) - stiffness*slip
            call return_to_disc(points%law(k), norm2(q)/w, stiffness/w, press/w, points%at(k), &
               & bound, slope_q, slope_p)
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
end module lopin_friction_history
