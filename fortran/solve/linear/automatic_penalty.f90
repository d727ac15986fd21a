!> Nodal stiffnesses: the deck's slope times area, or chosen from the compliance of the contact
!> itself.
!>
!> The relative pressure error of a penalty is beta = 1/(1 + epsilon*s), s an eigenvalue of the
!> compliance per area W^1/2 S W^1/2; so epsilon = (1/beta - 1)/s_min keeps it below the target for
!> every pressure. No unit enters, and no modulus: the stiffer and the softer body are both in S.
module lopin_automatic_penalty
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_dense, only : cholesky, cholesky_solve, symmetric_eigen
   use lopin_condensed, only : form_compliance
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: set_stiffness, wants_compliance

contains

   !> alpha of all rows.
   subroutine set_stiffness(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, from, to
      real(wp), allocatable :: weight(:)
      real(wp) :: slope, least

      associate (p => scene%problem)
         allocate (weight(p%nrow))
         weight(:) = scene%points%weight(scene%rows%point(:p%nrow))
         p%alpha = weight
         scene%stiffer = scene%trial%contact%stiffer
         do pair = 1, p%ngroup
            from = p%group_first(pair)
            to = p%group_first(pair + 1) - 1
            if (to < from) cycle
            associate (law => model%interaction(model%pair(pair)%interaction))
               if (.not. law%method%piecewise_linear()) cycle
               if (.not. law%method%reads_slope()) then
                  p%alpha(from:to) = 0.0_wp
                  cycle
               end if
               slope = law%slope*law%scale
               if (.not. slope > 0.0_wp) then
                  call form_compliance(p)
                  least = least_compliance(p%s(from:to, from:to), weight(from:to), p%c(from:to, :))
                  ! Supports that are artificial hold every row of the pair.
                  if (.not. least > 0.0_wp) least = least_compliance(p%s, weight, p%c)
                  if (.not. least > 0.0_wp) least = compliance_of_nodes(scene, weight)
                  slope = (1.0_wp/model%target_error - 1.0_wp)/least
                  slope = slope*law%scale*scene%trial%contact%stiffer
                  call warn_once(scene, model, pair, slope)
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
         associate (law => model%interaction(model%pair(pair)%interaction))
            wants_compliance = wants_compliance .or. (law%method%reads_slope() &
               & .and. .not. law%slope*law%scale > 0.0_wp)
         end associate
      end do
   end function wants_compliance

   subroutine warn_once(scene, model, pair, slope)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: slope
      integer :: i

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'N0317' &
            & .and. scene%log%item(i)%at%line == model%pair(pair)%at%line) return
      end do
      call scene%log%say(severity%note, 'N0317', 'the stiffness of this pair was chosen: '// &
         & to_text(real(slope, wp))//' pressure per length, for a pressure error below '// &
         & to_text(model%target_error), model%pair(pair)%at)
   end subroutine warn_once

   !> What a node alone gives way by, per area: of rows that meet supports only.
   real(wp) function compliance_of_nodes(scene, weight) result(compliance)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: weight(:)        !! (n) [length^2]
      real(wp) :: diagonal(scene%dofs%n)

      call scene%k%diagonal(diagonal)
      compliance = maxval(weight)/maxval(diagonal)
   end function compliance_of_nodes

   !> Least eigenvalue of W^1/2 S W^1/2 among the pressures that leave floating motions in balance
   !> (on the others S depends on where the artificial supports stand): Lanczos' iteration on the
   !> inverse, from a vector that has a share of every mode. It converges beyond what the numbering
   !> of the rows could change.
   function least_compliance(s, weight, c) result(least)
      real(wp), intent(in) :: s(:, :)      !! (n, n) [length/force]
      real(wp), intent(in) :: weight(:)    !! (n) [length^2]
      real(wp), intent(in) :: c(:, :)      !! (n, nq) rows on the floating motions
      real(wp) :: least
      real(wp), allocatable :: a(:, :)
      real(wp) :: mean
      integer :: i, status, n

      n = size(weight)
      allocate (a(n, n))
      do i = 1, n
         a(:, i) = s(:, i)*sqrt(weight*weight(i))
      end do
      call balance(a, spread(sqrt(weight), 2, size(c, 2))*c)
      mean = 0.0_wp
      do i = 1, n
         mean = mean + a(i, i)/n
      end do
      least = mean
      do i = 1, n
         if (a(i, i) > 0.0_wp) least = min(least, a(i, i))
      end do
      call cholesky(a, status)
      if (status /= 0) return
      least = max(1.0_wp/largest_of_inverse(a), 1.0e-4_wp*mean)
   end function least_compliance

   !> a <- P a P + mean*(1 - P), P the projection across the columns of `c`; as it is if they span
   !> everything.
   subroutine balance(a, c)
      real(wp), intent(inout) :: a(:, :)
      real(wp), intent(in) :: c(:, :)
      real(wp) :: q(size(c, 1), size(c, 2)), v(size(c, 1)), before, mean
      integer :: i, n, rank

      n = size(a, 1)
      rank = 0
      do i = 1, size(c, 2)
         v = c(:, i)
         before = norm2(v)
         v = v - matmul(q(:, :rank), matmul(v, q(:, :rank)))
         v = v - matmul(q(:, :rank), matmul(v, q(:, :rank)))
         if (.not. norm2(v) > 1.0e-8_wp*before) cycle
         rank = rank + 1
         q(:, rank) = v/norm2(v)
      end do
      if (rank == 0 .or. rank >= n) return
      associate (b => q(:, :rank))
         a = a - matmul(b, matmul(transpose(b), a))
         a = a - matmul(matmul(a, b), transpose(b))
         mean = 0.0_wp
         do i = 1, n
            mean = mean + a(i, i)/(n - rank)
         end do
         a = a + mean*matmul(b, transpose(b))
      end associate
   end subroutine balance

   !> Largest eigenvalue of the inverse of L L^T.
   function largest_of_inverse(l) result(largest)
      real(wp), intent(in) :: l(:, :)              !! (n, n) Cholesky factor
      real(wp) :: largest
      integer, parameter :: most_steps = 150, steady_steps = 3
      real(wp), parameter :: steady = 1.0e-14_wp
      real(wp), allocatable :: q(:, :), r(:), t(:, :), small(:, :), value(:)
      real(wp) :: previous, rest
      integer :: i, step, last, status, same, n

      n = size(l, 1)
      last = min(n, most_steps)
      allocate (q(n, last), t(last, last), source=0.0_wp)
      ! Mode shapes of the stiffest pressures alternate; the rest keeps the vector off every
      ! symmetry.
      r = [(merge(1.0_wp, -1.0_wp, mod(i, 2) == 0)*(1.0_wp + 0.5_wp*modulo(0.618_wp*i, 1.0_wp)), &
         & i=1, n)]
      largest = 0.0_wp
      same = 0
      do step = 1, last
         q(:, step) = r/norm2(r)
         r = q(:, step)
         call cholesky_solve(l, r)
         t(step, step) = dot_product(q(:, step), r)
         do i = 1, 2
            r = r - matmul(q(:, :step), matmul(r, q(:, :step)))
         end do
         previous = largest
         small = t(:step, :step)
         allocate (value(step))
         call symmetric_eigen(small, value, status)
         largest = maxval(value)
         deallocate (value)
         same = merge(same + 1, 0, largest - previous <= steady*largest)
         rest = norm2(r)
         if (same == steady_steps .or. step == last .or. .not. rest > epsilon(1.0_wp)*largest) exit
         t(step, step + 1) = rest
         t(step + 1, step) = rest
      end do
   end function largest_of_inverse
end module lopin_automatic_penalty
