!> Slip increments of the points on the present shape: slip, its work, elastic energy, bounds of
!> shear.
module lopin_slip_increment
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, has_friction, is_regularised, &
      & friction_radius, lost_at_touch
   use lopin_friction_return, only : drag_limit
   use lopin_contact_row, only : contact_status
   use lopin_contact_traction, only : elastic_slip_of, stored_energy
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   implicit none
   private
   public :: condition_at, anchor_slip, slip_from_anchor, path_of, dissipated, mean_work_of
   public :: held_energy, shear_bound, shear_excess, speed_of, lost_bound, turn
   public :: note_sliding, forget_sliding, shear_of

   !> Share of the increment that rates of slip are at least taken over.
   real(wp), parameter :: least_left = 0.1_wp

contains

   !> What the law of friction reads at a point besides pressure and slip.
   pure function condition_at(self, i) result(at)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      type(condition_type) :: at
      at = condition_type(yield=self%yield(i), mises=self%mises(i), &
         & dt=time_of_slip(self, i), &
         & speed=self%speed(i), of_trial=self%speed_of_trial, &
         & held=self%enforcement(i)%bilateral, growth=self%growth(i)%ratio, eased=self%eased(i))
   end function condition_at

   !> Time that the slip of the increment took: since the point touched.
   pure real(wp) function time_of_slip(self, i) result(time)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      time = self%dt*max(1.0_wp - self%touch(i), least_left)
   end function time_of_slip

   !> The slip of the trial state that is not given back: what it is more than elastic slip.
   pure function lost_slip(self, i) result(slip)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slip(3)

      slip = 0.0_wp
      if (self%facet(i) == 0 .or. self%trial(i)%status /= contact_status%slip) return
      associate (t => self%trial(i), g => self%enforcement(i), law => self%friction(self%pair(i)))
         if (.not. has_friction(law)) return
         slip = t%slip
         if (is_regularised(law)) then
            if (.not. drag_limit(law) < huge(1.0_wp)) return
            slip = slip_from_anchor(self, i)
            slip = slip - anchor_slip(law, slip)
            return
         end if
         slip = slip - elastic_slip_of(g, law, condition_at(self, i), self%pressure(i), &
            & t%traction - self%pressure(i)*t%normal)
         if (g%elastic_slip > 0.0_wp) slip = slip + g%elastic
         if (.not. g%elastic_slip > 0.0_wp) slip = slip + elastic_slip_of(g, law, &
            & condition_at(self, i), self%pressure(i), along(g%committed, t%normal))
      end associate
   end function lost_slip

   !> Slip from the stick anchor, as a law regularised by slip measures it: in the tangent plane of
   !> the trial.
   pure function slip_from_anchor(self, i) result(slip)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slip(3)
      slip = along(self%enforcement(i)%creep, self%trial(i)%normal) + self%trial(i)%slip
   end function slip_from_anchor

   !> Slip from the stick anchor after the anchor has followed.
   pure function anchor_slip(law, slip) result(left)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: slip(3)          !! [length]
      real(wp) :: left(3), limit

      left = slip
      limit = drag_limit(law)
      if (norm2(slip) > limit) left = slip*(limit/norm2(slip))
   end function anchor_slip

   !> Way slid in the increment, with friction only what is not given back.
   pure real(wp) function path_of(self, i) result(way)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      way = norm2(self%trial(i)%slip)
      associate (law => self%friction(self%pair(i)))
         if (has_friction(law) .and. .not. is_regularised(law)) way = norm2(lost_slip(self, i))
      end associate
   end function path_of

   !> Friction work per area of the trial state, in this increment, as its law has it: by the
   !> traction at the end, never negative [stress*length].
   pure real(wp) function dissipated(self, i)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      dissipated = -dot_product(self%trial(i)%traction, lost_slip(self, i))
   end function dissipated

   !> The same by the mean of the tractions at start and end, as the work of external forces is
   !> counted: negative where friction turns round while the pressure falls [stress*length].
   pure real(wp) function mean_work_of(self, i) result(work)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: before(3)

      associate (t => self%trial(i))
         before = self%enforcement(i)%committed
         ! On a curved master the pressure of the start would work along the chord of the way.
         if (self%opposite(i)%facet > 0) call turn(self%start_normal(:, i), t%normal, before)
         work = -0.5_wp*dot_product(t%traction + along(before, t%normal), lost_slip(self, i))
      end associate
   end function mean_work_of

   !> Energy per area that a point's springs hold [stress*length].
   pure real(wp) function held_energy(self, i) result(energy)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      energy = 0.0_wp
      if (self%facet(i) == 0 .or. self%trial(i)%status == 0) return
      associate (t => self%trial(i), p => self%pressure(i), law => self%friction(self%pair(i)))
         energy = stored_energy(self%enforcement(i), law, condition_at(self, i), p, &
            & merge(1.0_wp, 0.0_wp, has_friction(law))*along(t%traction, t%normal), self%gap(i), &
            & kept_slip(self, i))
      end associate
   end function held_energy

   !> Slip from the anchor that a law regularised by slip keeps.
   pure function kept_slip(self, i) result(slip)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slip(3)

      slip = 0.0_wp
      associate (law => self%friction(self%pair(i)))
         if (.not. has_friction(law) .or. .not. is_regularised(law)) return
         if (drag_limit(law) < huge(1.0_wp)) slip = anchor_slip(law, slip_from_anchor(self, i))
      end associate
   end function kept_slip

   !> Largest shear that the law of friction allows a point; huge: no bound [stress].
   pure real(wp) function shear_bound(self, i) result(radius)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slope

      radius = huge(1.0_wp)
      associate (law => self%friction(self%pair(i)))
         if (has_friction(law)) call friction_radius(law, self%pressure(i), condition_at(self, i), &
            & radius, slope)
      end associate
   end function shear_bound

   !> The most that a shear lies beyond its bound, beside the largest bound, or beside what rounding
   !> of places makes of the forces of the largest penalty.
   pure real(wp) function shear_excess(self, noise) result(excess)
      type(nonlinear_contact_type), intent(in) :: self
      real(wp), intent(in) :: noise            !! of places [length]
      real(wp) :: bound, most, shear(3)
      integer :: i

      excess = 0.0_wp
      if (self%n == 0) return
      most = noise*maxval(abs(self%c(:self%n)))
      do i = 1, self%n
         if (self%facet(i) == 0 .or. self%enforcement(i)%tied) cycle
         bound = shear_bound(self, i)
         if (.not. bound < huge(1.0_wp)) cycle
         shear = shear_of(self, i)
         most = max(most, bound)
         excess = max(excess, norm2(shear) - bound - noise*self%c(i))
      end do
      if (excess > 0.0_wp) excess = excess/most
   end function shear_excess

   !> The part of the traction of a point along its tangents [stress].
   pure function shear_of(self, i) result(shear)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: shear(3)

      shear = self%traction(:, i) - self%pressure(i)*self%normal(:, i)
   end function shear_of

   !> Where a step of Newton starts: how points slide there. They stick before they slide the other
   !> way. What gives way before it slides has a way to leap into.
   pure subroutine note_sliding(self)
      type(nonlinear_contact_type), intent(inout) :: self
      integer :: i

      call forget_sliding(self)
      do i = 1, self%n
         associate (e => self%enforcement(i))
            if (self%status(i) /= contact_status%slip) cycle
            if (.not. e%method%is_exact() .or. e%method%updates()) cycle
            e%slid = shear_of(self, i)
         end associate
      end do
   end subroutine note_sliding

   pure subroutine forget_sliding(self)
      type(nonlinear_contact_type), intent(inout) :: self
      integer :: i

      do i = 1, self%n
         self%enforcement(i)%slid = 0.0_wp
      end do
   end subroutine forget_sliding

   !> What a closed point lacks of its bound because it is pressed lightly, and the bound.
   pure subroutine lost_bound(self, i, lost, whole)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(out) :: lost, whole     !! [stress]
      type(condition_type) :: at

      lost = 0.0_wp
      whole = 0.0_wp
      if (self%facet(i) == 0 .or. self%trial(i)%status == 0) return
      associate (law => self%friction(self%pair(i)))
         if (.not. has_friction(law)) return
         at = condition_at(self, i)
         at%speed = speed_of(self, i)
         call lost_at_touch(law, self%pressure(i), at, lost, whole)
         if (self%trial(i)%status /= contact_status%slip) lost = 0.0_wp
      end associate
   end subroutine lost_bound

   !> Speed of slip of the trial state [length/time].
   pure real(wp) function speed_of(self, i) result(speed)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      speed = norm2(lost_slip(self, i))/time_of_slip(self, i)
   end function speed_of

   pure function along(v, normal) result(t)
      real(wp), intent(in) :: v(3), normal(3)
      real(wp) :: t(3)
      t = v - dot_product(v, normal)*normal
   end function along

   !> The least rotation that takes one unit vector to another, applied to a third vector.
   pure subroutine turn(from, to, v)
      real(wp), intent(in) :: from(3), to(3)
      real(wp), intent(inout) :: v(3)
      real(wp) :: c, axis(3)

      ! What a run starts with has the normal of its start.
      if (.not. any(abs(from) > 0.0_wp)) return
      c = dot_product(from, to)
      if (.not. c > -0.5_wp .or. .not. any(abs(v) > 0.0_wp)) return
      axis = [from(2)*to(3) - from(3)*to(2), from(3)*to(1) - from(1)*to(3), &
         & from(1)*to(2) - from(2)*to(1)]
      v = c*v + [axis(2)*v(3) - axis(3)*v(2), axis(3)*v(1) - axis(1)*v(3), &
         & axis(1)*v(2) - axis(2)*v(1)] + axis*dot_product(axis, v)/(1.0_wp + c)
   end subroutine turn
end module lopin_slip_increment
