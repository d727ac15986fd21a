!> Nodal stiffnesses: the deck's slope times area, or chosen from the compliance of the contact itself.
!>
!> The relative pressure error of a penalty is beta = 1/(1 + epsilon*s), s an eigenvalue of the compliance
!> per area W^1/2 S W^1/2; so epsilon = (1/beta - 1)/s_min keeps it below the target for every pressure.
!> No unit enters, and no modulus: the stiffer and the softer body are both in S.
module lopin_automatic_penalty
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, method_of
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_condensed, only : form_compliance
   use lopin_scene, only : scene_type
   use lopin_methods, only : has_law
   implicit none
   private
   public :: set_stiffness, wants_compliance, least_compliance

contains

   !> alpha of all rows.
   subroutine set_stiffness(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, from, to
      real(wp), allocatable :: weight(:)
      real(wp) :: slope

      associate (p => scene%problem)
         allocate (weight(p%nrow))
         weight(:) = scene%points%weight(scene%rows%point)
         p%alpha = weight
         do pair = 1, p%ngroup
            from = p%group_first(pair)
            to = p%group_first(pair + 1) - 1
            if (to < from .or. has_law(model, pair)) cycle
            associate (law => model%interaction(model%pair(pair)%interaction))
               if (law%method == method_of%lagrange) then
                  p%alpha(from:to) = 0.0_wp
                  cycle
               end if
               slope = law%slope*law%scale
               if (.not. slope > 0.0_wp) then
                  call form_compliance(p)
                  slope = (1.0_wp/model%target_error - 1.0_wp)/least_compliance(p%s(from:to, from:to), weight(from:to))
                  slope = slope*law%scale
                  call say_once(scene, model, pair, slope)
               end if
               p%alpha(from:to) = slope*weight(from:to)
            end associate
         end do
      end associate
   end subroutine set_stiffness

   !> Some pair leaves its stiffness to the compliance of the contact.
   pure logical function wants_compliance(model)
      type(model_type), intent(in) :: model
      integer :: pair

      wants_compliance = .false.
      do pair = 1, size(model%pair)
         if (has_law(model, pair)) cycle
         associate (law => model%interaction(model%pair(pair)%interaction))
            wants_compliance = wants_compliance .or. (law%method /= method_of%lagrange &
               & .and. .not. law%slope*law%scale > 0.0_wp)
         end associate
      end do
   end function wants_compliance

   subroutine say_once(scene, model, pair, slope)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: slope
      integer :: i

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'N0317' .and. scene%log%item(i)%at%line == model%pair(pair)%at%line) return
      end do
      call scene%log%say(severity%note, 'N0317', 'the stiffness of this pair was chosen: '// &
         & to_text(real(slope, wp))//' pressure per length, for a pressure error below '// &
         & to_text(model%target_error), model%pair(pair)%at)
   end subroutine say_once

   !> Least eigenvalue of W^1/2 S W^1/2, by inverse iteration on its Cholesky factor.
   function least_compliance(s, weight) result(least)
      real(wp), intent(in) :: s(:, :)      !! (n, n) [length/force]
      real(wp), intent(in) :: weight(:)    !! (n) [length^2]
      real(wp) :: least
      real(wp), allocatable :: a(:, :), x(:)
      real(wp) :: mean, previous
      integer :: i, pass, status, n

      n = size(weight)
      allocate (a(n, n))
      mean = 0.0_wp
      do i = 1, n
         a(:, i) = s(:, i)*sqrt(weight*weight(i))
         mean = mean + a(i, i)/n
      end do
      least = mean
      do i = 1, n
         if (a(i, i) > 0.0_wp) least = min(least, a(i, i))
      end do
      call cholesky(a, status)
      if (status /= 0) return
      x = [(merge(1.0_wp, -1.0_wp, mod(i, 2) == 0), i=1, n)]
      do pass = 1, 30
         previous = least
         x = x/norm2(x)
         call cholesky_solve(a, x)
         least = 1.0_wp/norm2(x)
         if (abs(least - previous) < 1.0e-2_wp*least) exit
      end do
      least = max(least, 1.0e-4_wp*mean)
   end function least_compliance
end module lopin_automatic_penalty
