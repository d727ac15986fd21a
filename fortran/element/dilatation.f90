!> Change of volume of an element, taken from its points together: mean or linear.
!>
!> The change of volume of a point is replaced by its projection, by reference volume, onto a space
!> of functions of the element: the constant for mean dilatation, the functions linear in the
!> reference coordinates for full quadratic quads and bricks (as in the elements with eight nodes
!> and three pressures, twenty and four; Sussman and Bathe 1987). Functions phi that are
!> orthonormal over the reference volume say it: the projection of q is
!> sum_m phi_m (integral of phi_m q).
module lopin_dilatation
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_formulation
   implicit none
   private
   public :: dilatation_count, dilatation_functions, projection

contains

   !> How many functions; 0: every point keeps its own change of volume.
   pure integer function dilatation_count(element) result(count)
      type(element_type), intent(in) :: element

      count = 0
      if (element%formulation == element_formulation%bbar) count = 1
      if (element%formulation == element_formulation%projected) count = 1 + element%ndim
   end function dilatation_count

   !> The functions at the Gauss points.
   pure subroutine dilatation_functions(element, x, weight, phi)
      type(element_type), intent(in) :: element
      real(wp), contiguous, intent(in) :: x(:, :)   !! (ndim, nnode) reference coordinates [length]
      real(wp), intent(in) :: weight(:)        !! (ngauss) reference volumes [length^3]
      real(wp), contiguous, intent(out) :: phi(:, :)   !! (ngauss, dilatation_count) [length^-3/2]
      integer :: l, m

      do m = 1, size(phi, 2)
         if (m == 1) phi(:, m) = 1.0_wp
         if (m > 1) phi(:, m) = matmul(x(m - 1, :element%nnode), element%n)
         do l = 1, m - 1
            phi(:, m) = phi(:, m) - phi(:, l)*sum(weight*phi(:, l)*phi(:, m))
         end do
         phi(:, m) = phi(:, m)/sqrt(sum(weight*phi(:, m)**2))
      end do
   end subroutine dilatation_functions

   !> Sum of phi_m times the integral of phi_m q.
   pure function projection(phi, q) result(p)
      real(wp), contiguous, intent(in) :: phi(:, :)   !! (ngauss, dilatation_count)
      real(wp), contiguous, intent(in) :: q(:)        !! (ngauss) times reference volume
      real(wp) :: p(size(q))
      integer :: m

      p = 0.0_wp
      do m = 1, size(phi, 2)
         p = p + phi(:, m)*sum(phi(:, m)*q)
      end do
   end function projection
end module lopin_dilatation
