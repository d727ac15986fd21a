!> What contact on the present shape remembers: where increments start, what they leave.
module lopin_finite_history
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_contact_traction, only : grip_kind
   use lopin_finite_grips, only : remember_elastic
   use lopin_finite_points, only : finite_points_type
   use lopin_finite_samples, only : offset_of
   use lopin_finite_masters, only : move_masters
   use lopin_finite_growth, only : follow_areas
   use lopin_finite_owner, only : start_owners, commit_owners
   use lopin_finite_contact, only : finite_contact_type
   use lopin_finite_meeting, only : find_present, meet, take_anchor, share_roles
   use lopin_finite_faces, only : find_inner_feet
   use lopin_finite_touch, only : start_approach
   use lopin_finite_slip, only : drawn, path_of, dissipated, mean_work_of, speed_of, turn
   implicit none
   private
   public :: start_increment, augment, accept, reject

   !> A gap below this share of the facet touches.
   real(wp), parameter :: touching = 1.0e-10_wp

contains

   !> Search from the accepted state; anchors of friction; tractions turned with the normals.
   subroutine start_increment(self, model, u, dt, error)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) accepted displacements
      real(wp), intent(in) :: dt               !! [time]
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%dt = dt
      call move_masters(self%masters, model, self%dofs, self%finite_points_type, u, .true., &
         & self%cost, error)
      if (allocated(error)) return
      if (any(self%grip%kind == grip_kind%tied) .and. .not. allocated(self%tied_at)) &
         & self%tied_at = self%masters%x
      call start_owners(self%masters%owner)
      call find_present(self, .true., error)
      if (allocated(error)) return
      do i = 1, self%n
         call meet(self, model, i, .true.)
         if (.not. (self%grip(i)%kind == grip_kind%tied .and. self%anchor(i)%set)) then
            call take_anchor(self, model, i)
            self%anchor(i)%offset = offset_of(self%masters, self%finite_points_type, i)
         end if
         if (self%opposite(i)%facet > 0) self%masters%part(i) = self%opposite(i)%foot%segment
         associate (g => self%grip(i))
            g%ct = self%ct(i)
            g%c = self%c(i)
            g%grazing = touching*g%c*self%size(i)
            g%committed = self%lambda(:, i)
            g%creep = self%creep(:, i)
            if (self%opposite(i)%facet > 0) then
               call turn(self%last_normal(:, i), self%opposite(i)%normal, g%committed)
               call turn(self%last_normal(:, i), self%opposite(i)%normal, g%creep)
            end if
            self%start_normal(:, i) = self%opposite(i)%normal
            g%frozen = g%committed
            g%approach = 0.0_wp
            g%bilateral = self%closed(i) &
               & .and. model%interaction(model%pair(self%pair(i))%interaction)%no_separation
            self%bilateral(i) = g%bilateral .or. g%kind == grip_kind%tied
            g%yield = self%yield(i)
            call remember_elastic(g, self%friction(self%pair(i)), self%opposite(i)%normal)
         end associate
      end do
      call follow_areas(self, model)
      if (size(self%face) > 0) then
         self%start_x = self%masters%x
         call find_inner_feet(self%opposite, self%masters, self%finite_points_type, model, &
            & self%start_x)
      end if
      call start_approach(self)
      call share_roles(self, model)
   end subroutine start_increment

   !> Augmented Lagrangian: take the present tractions for the next solve.
   subroutine augment(self, change)
      type(finite_contact_type), intent(inout) :: self
      real(wp), intent(out) :: change          !! relative, of the tractions
      real(wp) :: most, moved
      integer :: i

      most = 0.0_wp
      moved = 0.0_wp
      do i = 1, self%n
         if (self%grip(i)%kind /= grip_kind%augmented .and. .not. self%grip(i)%augments) cycle
         most = max(most, norm2(self%traction(:, i)))
         moved = max(moved, norm2(self%traction(:, i) - self%grip(i)%frozen))
         self%grip(i)%frozen = self%traction(:, i)
      end do
      change = 0.0_wp
      if (most > 0.0_wp) change = moved/most
   end subroutine augment

   !> Commit the history of the last evaluation.
   subroutine accept(self)
      type(finite_contact_type), intent(inout) :: self
      integer :: i

      do i = 1, self%n
         call commit_owners(self%masters%owner, i, self%opposite(i)%past .and. self%status(i) /= 0)
         associate (t => self%trial(i))
            if (self%facet(i) == 0 .or. t%status == 0) then
               self%last_speed(i) = 0.0_wp
               ! A pair that is taken away has no memory when it comes back.
               if (.not. self%pair_active(self%pair(i))) self%closed(i) = .false.
               self%lambda(:, i) = 0.0_wp
               self%creep(:, i) = 0.0_wp
               if (self%facet(i) > 0) self%last_normal(:, i) = t%normal
               cycle
            end if
            self%closed(i) = .true.
            ! By the area that the next increment begins with.
            self%lambda(:, i) = t%traction/self%growth(i)%ratio
            self%last_normal(:, i) = t%normal
            self%slip(:, i) = self%slip(:, i) + t%slip
            self%creep(:, i) = drawn(self%friction(self%pair(i)), self%grip(i)%creep + t%slip)
            self%slip_path(i) = self%slip_path(i) + path_of(self, i)
            self%last_speed(i) = speed_of(self, i)
            self%friction_work(i) = self%friction_work(i) + dissipated(self, i)*self%weight(i)
            self%mean_work(i) = self%mean_work(i) + mean_work_of(self, i)*self%weight(i)
         end associate
      end do
   end subroutine accept

   !> Back to the history that was committed last: what is not committed is only overwritten.
   subroutine reject(self)
      type(finite_contact_type), intent(inout) :: self
      self%nlocal = 0
   end subroutine reject
end module lopin_finite_history
