program test_quadrature
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_quadrature, only : rule_type, new_rule, new_layered_rule
   use check, only : test, close_to, is_true, finish
   implicit none
   character(len=*), parameter :: family_names(6) = [character(len=10) :: 'line', 'triangle', &
      & 'quad', &
      & 'tetra', 'wedge', 'hexahedron']
   integer :: family, degree
   type(rule_type) :: rule

   do family = 1, 6
      do degree = 0, 8
         call new_rule(rule, family, degree)
         call monomials_are_exact(rule)
      end do
   end do
   call a_wedge_may_have_its_own_degree_along_the_axis()
   call layers_integrate_a_jump_in_the_middle()
   call finish()

contains

   subroutine monomials_are_exact(rule)
      type(rule_type), intent(in) :: rule
      real(wp) :: sum_
      integer :: i, j, k, ndim

      call test('monomials up to the degree are integrated exactly: '//family_names(family))
      ndim = size(rule%xi, 1)
      call is_true('positive weights', all(rule%weight > 0.0_wp))
      do k = 0, merge(degree, 0, ndim > 2)
         do j = 0, merge(degree - k, 0, ndim > 1)
            do i = 0, degree - j - k
               sum_ = sum(rule%weight*rule%xi(1, :)**i*power(2, j)*power(3, k))
               call close_to('integral', sum_, exact(i, j, k), 1.0e-14_wp)
            end do
         end do
      end do
   end subroutine monomials_are_exact

   pure function power(direction, exponent) result(values)
      integer, intent(in) :: direction, exponent
      real(wp) :: values(rule%npoint)
      values = 1.0_wp
      if (exponent > 0) values = rule%xi(direction, :)**exponent
   end function power

   !> Integral of x**i y**j z**k over the reference cell.
   pure real(wp) function exact(i, j, k)
      integer, intent(in) :: i, j, k
      select case (family)
      case (cell_family%line)
         exact = segment(i)
      case (cell_family%quad)
         exact = segment(i)*segment(j)
      case (cell_family%hexahedron)
         exact = segment(i)*segment(j)*segment(k)
      case (cell_family%triangle)
         exact = factorial(i)*factorial(j)/factorial(i + j + 2)
      case (cell_family%tetra)
         exact = factorial(i)*factorial(j)*factorial(k)/factorial(i + j + k + 3)
      case default
         exact = factorial(i)*factorial(j)/factorial(i + j + 2)*segment(k)
      end select
   end function exact

   pure real(wp) function segment(i)
      integer, intent(in) :: i
      segment = merge(2.0_wp/real(i + 1, wp), 0.0_wp, mod(i, 2) == 0)
   end function segment

   pure real(wp) function factorial(i)
      integer, intent(in) :: i
      factorial = gamma(real(i + 1, wp))
   end function factorial

   subroutine a_wedge_may_have_its_own_degree_along_the_axis()
      call test('a wedge of degree 2 and 5 along its axis has nine points')
      call new_rule(rule, cell_family%wedge, 2, through=5)
      call is_true('nine', rule%npoint == 9)
      call close_to('t**4', sum(rule%weight*rule%xi(3, :)**4), 0.2_wp, 1.0e-14_wp)
   end subroutine a_wedge_may_have_its_own_degree_along_the_axis

   !> Moments of a stress that jumps where the direction does: |x| and sign(x) x^2 y^2.
   subroutine layers_integrate_a_jump_in_the_middle()
      integer :: layers(3), d, other

      call test('layered rules integrate a jump in the middle')
      do d = 1, 3
         layers = 0
         layers(d) = 1
         other = 1 + mod(d, 3)
         call new_layered_rule(rule, cell_family%hexahedron, 3, layers)
         call is_true('24 points of positive weight', rule%npoint == 24 .and. &
            & all(rule%weight > 0.0_wp))
         call close_to('moment', sum(rule%weight*abs(rule%xi(d, :))), 4.0_wp, 1.0e-14_wp)
         call close_to('product', sum(rule%weight*abs(rule%xi(d, :)**3)*rule%xi(other, :)**2), &
            & 2.0_wp/3.0_wp, 1.0e-14_wp)
      end do
      layers = [0, 1, 0]
      call new_layered_rule(rule, cell_family%quad, 5, layers)
      call is_true('30 points in the plane', rule%npoint == 30)
      call close_to('area', sum(rule%weight), 4.0_wp, 1.0e-14_wp)
      call close_to('moment in the plane', sum(rule%weight*abs(rule%xi(2, :))), 2.0_wp, 1.0e-14_wp)
      call new_layered_rule(rule, cell_family%quad, 1, [2, 0, 0])
      call is_true('one of two layers has 6 points', rule%npoint == 6)
      call close_to('moment of it', sum(rule%weight*abs(rule%xi(1, :))), 2.0_wp, 1.0e-14_wp)
   end subroutine layers_integrate_a_jump_in_the_middle
end program test_quadrature
