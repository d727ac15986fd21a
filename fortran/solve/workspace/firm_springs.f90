!> Firm springs of contact points whose tractions are unknowns, for a better preconditioner.
!>
!> With l = l' - q c R u (the augmented Lagrangian's change of unknown) the system of displacements
!> has q + 1 times the springs, and rows see next to nothing but these:
!>
!>    S = D - (1 - q c D) R (B + N^T (stiff + q firm) N)^-1 C
!>
!> of one point alone, B the diagonal of the body, is close to what elimination of all displacements
!> leaves. N: how far the point goes; R, C, D: its rows and columns. The residual that GMRES
!> minimises stays that of the true unknowns.
module lopin_firm_springs
   use lopin_kinds, only : wp
   use lopin_local_matrix, only : local_matrix_type
   use lopin_contact_block, only : block_type, rest_of
   implicit none
   private
   public :: set_firm, push_back, give_back

   !> q. More takes digits from the factor, and friction's coupling is all that is left anyway.
   real(wp), parameter :: firmness = 30.0_wp
   !> Shares below this are not made up for: rounding.
   real(wp), parameter :: smallest = 1.0e-3_wp
   !> What a body opposes, beside its diagonal, and what one opposes that has none, beside springs.
   real(wp), parameter :: yields = 0.5_wp, least = 1.0e-6_wp
   !> A pivot of c S below which nothing determines the traction.
   real(wp), parameter :: counts = 1.0e-8_wp

contains

   !> What stiffens the spring of a block, and the inverse of c S.
   subroutine set_firm(block, local, neq, scale, area, diagonal)
      type(block_type), intent(inout) :: block
      type(local_matrix_type), intent(in) :: local
      integer, intent(in) :: neq
      real(wp), intent(in) :: scale(:), area(:)    !! (nmultiplier) of rows, of multipliers
      real(wp), intent(in) :: diagonal(:)          !! (neq) of K
      real(wp), dimension(size(block%reach, 1), size(block%reach, 1)) :: firm, stiff, own, s, q
      real(wp), dimension(size(block%reach, 1), block%nu) :: n, r
      real(wp) :: column(block%nu, size(block%reach, 1)), compliance(block%nu), c
      integer :: i, d, nu

      d = size(block%reach, 1)
      nu = block%nu
      if (size(block%reach, 2) /= nu .or. block%nrow /= d) return
      associate (row => block%at(nu + 1) - neq)
         if (row < 1 .or. any(block%at(nu + 1:nu + d) /= neq + row + [(i, i=0, d - 1)])) return
         c = scale(row)/area(row)
         if (allocated(block%glue)) then
            r = rest_of(block)
            column = -block%glue%weight*transpose(r)
            own = c*block%glue%give(:d, :d)
         else
            r = block%k(nu + 1:nu + d, :nu)
            column = block%k(:nu, nu + 1:nu + d)
            own = c*block%k(nu + 1:nu + d, nu + 1:nu + d)
         end if
         n = block%reach
         block%firmness = firmness
         if (block%tied) then
            ! What is left are rows along axes.
            n = rest_of(block)
            block%firmness(:d) = [(firmness/largest_square(n(i, :)), i=1, d)]
         end if
         q = spread(block%firmness(:d), 2, d)
         firm = q*local%firm
         stiff = local%stiff + firm
         do i = 1, nu
            ! A tool that only contact holds has no stiffness of its own.
            compliance(i) = max(yields*diagonal(block%at(i)), least*dot_product(n(:, i), &
               & matmul(stiff, n(:, i))))
            if (compliance(i) > 0.0_wp) compliance(i) = 1.0_wp/compliance(i)
         end do
         s = seen_by_rows(r, column, n, stiff, compliance)
         block%inner = inverse(own - c*s + q*c*matmul(own, s), counts)
         if (block%tied) call leave_tied_rows(block)
         if (allocated(block%glue)) then
            block%firm = matmul(transpose(n), matmul(firm, n))
         else
            block%firm = firmness*matmul(transpose(n), matmul(local%firm, n))
         end if
      end associate
   end subroutine set_firm

   !> The spring of a row goes by its largest share: that of a node which supports hold is small.
   pure real(wp) function largest_square(row) result(most)
      real(wp), intent(in) :: row(:)

      most = max(maxval(row**2), smallest**2)
   end function largest_square

   !> The multipliers of eliminated rows follow from their equations.
   pure subroutine leave_tied_rows(block)
      type(block_type), intent(inout) :: block
      integer :: k

      do k = 1, size(block%inner, 1)
         if (block%own(k) == 0) cycle
         block%inner(k, :) = 0.0_wp
         block%inner(:, k) = 0.0_wp
      end do
   end subroutine leave_tied_rows

   !> R (1/compliance + N^T stiff N)^-1 C by Woodbury's formula.
   pure function seen_by_rows(r, column, n, stiff, compliance) result(s)
      real(wp), intent(in) :: r(:, :)              !! (ndim, nu) rows
      real(wp), intent(in) :: column(:, :)         !! (nu, ndim)
      real(wp), intent(in) :: n(:, :)              !! (ndim, nu)
      real(wp), intent(in) :: stiff(:, :)          !! (ndim, ndim) [force/length]
      real(wp), intent(in) :: compliance(:)        !! (nu) [length/force]
      real(wp), dimension(size(n, 1), size(n, 1)) :: s, middle
      real(wp) :: soft(size(compliance), size(n, 1))
      integer :: i

      soft = transpose(n)
      do i = 1, size(n, 1)
         soft(:, i) = compliance*soft(:, i)
      end do
      middle = matmul(stiff, matmul(n, soft))
      do i = 1, size(n, 1)
         middle(i, i) = middle(i, i) + 1.0_wp
      end do
      s = -matmul(matmul(r, soft), matmul(inverse(middle, 0.0_wp), matmul(stiff, &
         & matmul(transpose(soft), column))))
      do i = 1, size(n, 1)
         s(:, i) = s(:, i) + matmul(r, compliance*column(:, i))
      end do
   end function seen_by_rows

   !> The inverse of a small matrix by Gauss and Jordan; a pivot that vanishes is one.
   pure function inverse(matrix, least) result(b)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(in) :: least
      real(wp), dimension(size(matrix, 1), size(matrix, 1)) :: a, b
      real(wp) :: swap(size(matrix, 1)), factor
      integer :: i, j, p, n

      n = size(matrix, 1)
      a = matrix
      b = 0.0_wp
      do i = 1, n
         b(i, i) = 1.0_wp
      end do
      do j = 1, n
         p = j - 1 + maxloc(abs(a(j:, j)), dim=1)
         if (.not. abs(a(p, j)) > least) then
            a(j, j) = 1.0_wp
            p = j
         end if
         swap = a(p, :)
         a(p, :) = a(j, :)
         a(j, :) = swap/swap(j)
         factor = swap(j)
         swap = b(p, :)
         b(p, :) = b(j, :)
         b(j, :) = swap/factor
         do i = 1, n
            if (i == j) cycle
            b(i, :) = b(i, :) - a(i, j)*b(j, :)
            a(i, :) = a(i, :) - a(i, j)*a(j, :)
         end do
      end do
   end function inverse

   !> dl of a block, and what it leaves of the forces.
   pure subroutine push_back(block, force, y)
      type(block_type), intent(in) :: block
      real(wp), intent(inout) :: force(:)          !! (neq)
      real(wp), intent(inout) :: y(:)              !! dl behind neq
      integer :: i, j, d

      associate (at => block%at, nu => block%nu)
         if (allocated(block%inner)) then
            d = size(block%inner, 1)
            y(at(nu + 1:nu + d)) = matmul(block%inner, y(at(nu + 1:nu + d)))
         end if
         if (allocated(block%glue)) then
            if (allocated(block%spring)) force(at(:nu)) = force(at(:nu)) + block%glue%weight &
               & *matmul(y(at(nu + 1:nu + block%nrow)), block%reach)
            return
         end if
         do j = nu + 1, nu + block%nrow
            do i = 1, nu
               force(at(i)) = force(at(i)) - block%k(i, j)*y(at(j))
            end do
         end do
      end associate
   end subroutine push_back

   !> dl of the true unknowns.
   pure subroutine give_back(block, neq, scale, area, y)
      type(block_type), intent(in) :: block
      integer, intent(in) :: neq
      real(wp), intent(in) :: scale(:), area(:)    !! (nmultiplier)
      real(wp), intent(inout) :: y(:)
      integer :: i, j

      if (.not. allocated(block%inner)) return
      associate (at => block%at, nu => block%nu)
         if (allocated(block%glue)) then
            associate (c => block%glue%c, row => at(nu + 1:nu + block%nrow))
               y(row) = y(row) - block%firmness(:size(row))*c*matmul(block%reach, y(at(:nu)))
            end associate
            return
         end if
         do i = nu + 1, nu + size(block%inner, 1)
            associate (c => scale(at(i) - neq)/area(at(i) - neq))
               do j = 1, nu
                  y(at(i)) = y(at(i)) - block%firmness(i - nu)*c*block%k(i, j)*y(at(j))
               end do
            end associate
         end do
      end associate
   end subroutine give_back
end module lopin_firm_springs
