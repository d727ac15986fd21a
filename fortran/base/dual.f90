!> Forward-mode derivatives: a number together with its slopes along a few directions.
!>
!> A kernel written in dual numbers gives its exact first derivatives beside its value (Wengert
!> 1964; no step, no truncation). Values of branches are compared by `%v`. A kernel of more inputs
!> than `dual_width` is run once for each block of directions.
module lopin_dual
   use lopin_kinds, only : wp
   implicit none
   private
   public :: dual_type, dual_width, variable, constant, dual_dot, dual_cross, dual_norm
   public :: operator(+), operator(-), operator(*), operator(/), sqrt, atan, tanh, exp, log, sin, &
      & cos
   public :: assignment(=), operator(**)

   integer, parameter :: dual_width = 16

   type :: dual_type
      real(wp) :: v = 0.0_wp                     !! value
      real(wp) :: d(dual_width) = 0.0_wp         !! slope along each direction
   end type dual_type

   interface operator(+)
      procedure add, add_real, real_add
   end interface
   interface operator(-)
      procedure negate, subtract, subtract_real, real_subtract
   end interface
   interface operator(*)
      procedure multiply, multiply_real, real_multiply
   end interface
   interface operator(/)
      procedure divide, divide_real, real_divide
   end interface
   interface operator(**)
      procedure power
   end interface
   interface assignment(=)
      procedure assign_real
   end interface
   interface sqrt
      procedure dual_sqrt
   end interface
   interface atan
      procedure dual_atan
   end interface
   interface tanh
      procedure dual_tanh
   end interface
   interface exp
      procedure dual_exp
   end interface
   interface log
      procedure dual_log
   end interface
   interface sin
      procedure dual_sin
   end interface
   interface cos
      procedure dual_cos
   end interface

contains

   !> An input: its slope is 1 along direction k; none if k is outside 1..dual_width.
   elemental function variable(x, k) result(y)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      type(dual_type) :: y
      y%v = x
      y%d = 0.0_wp
      if (k >= 1 .and. k <= dual_width) y%d(k) = 1.0_wp
   end function variable

   !> A number without slopes.
   elemental function constant(x) result(y)
      real(wp), intent(in) :: x
      type(dual_type) :: y
      y%v = x
      y%d = 0.0_wp
   end function constant

   elemental subroutine assign_real(y, x)
      type(dual_type), intent(out) :: y
      real(wp), intent(in) :: x
      y%v = x
      y%d = 0.0_wp
   end subroutine assign_real

   elemental function add(a, b) result(c)
      type(dual_type), intent(in) :: a, b
      type(dual_type) :: c
      c%v = a%v + b%v
      c%d = a%d + b%d
   end function add

   elemental function add_real(a, b) result(c)
      type(dual_type), intent(in) :: a
      real(wp), intent(in) :: b
      type(dual_type) :: c
      c%v = a%v + b
      c%d = a%d
   end function add_real

   elemental function real_add(a, b) result(c)
      real(wp), intent(in) :: a
      type(dual_type), intent(in) :: b
      type(dual_type) :: c
      c%v = a + b%v
      c%d = b%d
   end function real_add

   elemental function negate(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = -a%v
      c%d = -a%d
   end function negate

   elemental function subtract(a, b) result(c)
      type(dual_type), intent(in) :: a, b
      type(dual_type) :: c
      c%v = a%v - b%v
      c%d = a%d - b%d
   end function subtract

   elemental function subtract_real(a, b) result(c)
      type(dual_type), intent(in) :: a
      real(wp), intent(in) :: b
      type(dual_type) :: c
      c%v = a%v - b
      c%d = a%d
   end function subtract_real

   elemental function real_subtract(a, b) result(c)
      real(wp), intent(in) :: a
      type(dual_type), intent(in) :: b
      type(dual_type) :: c
      c%v = a - b%v
      c%d = -b%d
   end function real_subtract

   elemental function multiply(a, b) result(c)
      type(dual_type), intent(in) :: a, b
      type(dual_type) :: c
      c%v = a%v*b%v
      c%d = a%d*b%v + a%v*b%d
   end function multiply

   elemental function multiply_real(a, b) result(c)
      type(dual_type), intent(in) :: a
      real(wp), intent(in) :: b
      type(dual_type) :: c
      c%v = a%v*b
      c%d = a%d*b
   end function multiply_real

   elemental function real_multiply(a, b) result(c)
      real(wp), intent(in) :: a
      type(dual_type), intent(in) :: b
      type(dual_type) :: c
      c%v = a*b%v
      c%d = a*b%d
   end function real_multiply

   elemental function divide(a, b) result(c)
      type(dual_type), intent(in) :: a, b
      type(dual_type) :: c
      c%v = a%v/b%v
      c%d = (a%d - c%v*b%d)/b%v
   end function divide

   elemental function divide_real(a, b) result(c)
      type(dual_type), intent(in) :: a
      real(wp), intent(in) :: b
      type(dual_type) :: c
      c%v = a%v/b
      c%d = a%d/b
   end function divide_real

   elemental function real_divide(a, b) result(c)
      real(wp), intent(in) :: a
      type(dual_type), intent(in) :: b
      type(dual_type) :: c
      c%v = a/b%v
      c%d = -c%v/b%v*b%d
   end function real_divide

   !> Real power of a positive number.
   elemental function power(a, b) result(c)
      type(dual_type), intent(in) :: a
      real(wp), intent(in) :: b
      type(dual_type) :: c
      c%v = a%v**b
      c%d = b*a%v**(b - 1.0_wp)*a%d
   end function power

   elemental function dual_sqrt(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = sqrt(a%v)
      c%d = a%d/(2.0_wp*c%v)
   end function dual_sqrt

   elemental function dual_atan(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = atan(a%v)
      c%d = a%d/(1.0_wp + a%v**2)
   end function dual_atan

   elemental function dual_tanh(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = tanh(a%v)
      c%d = (1.0_wp - c%v**2)*a%d
   end function dual_tanh

   elemental function dual_exp(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = exp(a%v)
      c%d = c%v*a%d
   end function dual_exp

   elemental function dual_log(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = log(a%v)
      c%d = a%d/a%v
   end function dual_log

   elemental function dual_sin(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = sin(a%v)
      c%d = cos(a%v)*a%d
   end function dual_sin

   elemental function dual_cos(a) result(c)
      type(dual_type), intent(in) :: a
      type(dual_type) :: c
      c%v = cos(a%v)
      c%d = -sin(a%v)*a%d
   end function dual_cos

   !> Scalar product.
   pure function dual_dot(a, b) result(c)
      type(dual_type), intent(in) :: a(:), b(:)
      type(dual_type) :: c
      integer :: i
      do i = 1, size(a)
         c = c + a(i)*b(i)
      end do
   end function dual_dot

   !> Vector product.
   pure function dual_cross(a, b) result(c)
      type(dual_type), intent(in) :: a(3), b(3)
      type(dual_type) :: c(3)
      c(1) = a(2)*b(3) - a(3)*b(2)
      c(2) = a(3)*b(1) - a(1)*b(3)
      c(3) = a(1)*b(2) - a(2)*b(1)
   end function dual_cross

   !> Length of a vector that is not zero.
   pure function dual_norm(a) result(c)
      type(dual_type), intent(in) :: a(:)
      type(dual_type) :: c
      c = sqrt(dual_dot(a, a))
   end function dual_norm
end module lopin_dual
