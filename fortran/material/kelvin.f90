!> Symmetric tensors as vectors of six in which products of tensors are products of vectors (Kelvin;
!> also named after Mandel): xx yy zz, then sqrt(2) times xy, xz, yz.
!>
!> A rotation of axes is then an orthogonal matrix, and a tangent of stress by strain has the same
!> form as its inverse: laws of materials need no factors of 2 for shears.
module lopin_kelvin
   use lopin_kinds, only : wp
   use lopin_log_strain, only : first_axis, second_axis
   implicit none
   private
   public :: kelvin_of, tensor_of, kelvin_rotation, solve_positive, positive_factor
   public :: root_two, unit_kelvin, deviator_of

   real(wp), parameter :: root_two = sqrt(2.0_wp)
   !> The unit tensor.
   real(wp), parameter :: unit_kelvin(6) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]

contains

   !> A symmetric tensor as a vector of six, shears times sqrt 2 (Kelvin).
   pure function kelvin_of(tensor) result(vector)
      real(wp), intent(in) :: tensor(3, 3)   !! symmetric
      real(wp) :: vector(6)
      integer :: r

      do r = 1, 6
         vector(r) = tensor(first_axis(r), second_axis(r))
      end do
      vector(4:) = root_two*vector(4:)
   end function kelvin_of

   !> A vector of six as a symmetric tensor.
   pure function tensor_of(vector) result(tensor)
      real(wp), intent(in) :: vector(6)
      real(wp) :: tensor(3, 3)
      integer :: r

      do r = 1, 6
         tensor(first_axis(r), second_axis(r)) = vector(r)
         if (r > 3) tensor(first_axis(r), second_axis(r)) = vector(r)/root_two
         tensor(second_axis(r), first_axis(r)) = tensor(first_axis(r), second_axis(r))
      end do
   end function tensor_of

   !> The vector less its mean normal component.
   pure function deviator_of(vector) result(deviator)
      real(wp), intent(in) :: vector(6)
      real(wp) :: deviator(6)
      deviator = vector - (vector(1) + vector(2) + vector(3))/3.0_wp*unit_kelvin
   end function deviator_of

   !> The matrix that takes vectors on axes of their own to those on which these axes are given.
   pure function kelvin_rotation(axis) result(map)
      real(wp), intent(in) :: axis(3, 3)     !! columns: unit vectors, orthogonal
      real(wp) :: map(6, 6)
      integer :: i, j, k, l, p, q

      do q = 1, 6
         k = first_axis(q)
         l = second_axis(q)
         do p = 1, 6
            i = first_axis(p)
            j = second_axis(p)
            if (q <= 3) then
               map(p, q) = axis(i, k)*axis(j, k)
            else
               map(p, q) = (axis(i, k)*axis(j, l) + axis(i, l)*axis(j, k))/root_two
            end if
            if (p > 3) map(p, q) = root_two*map(p, q)
         end do
      end do
   end function kelvin_rotation

   !> Cholesky factor of a symmetric positive definite matrix, in its lower triangle.
   pure subroutine positive_factor(a)
      real(wp), intent(inout) :: a(6, 6)
      integer :: i, j

      do j = 1, 6
         a(j, j) = sqrt(a(j, j) - sum(a(j, :j - 1)**2))
         do i = j + 1, 6
            a(i, j) = (a(i, j) - sum(a(i, :j - 1)*a(j, :j - 1)))/a(j, j)
         end do
      end do
   end subroutine positive_factor

   !> Solve with the factor.
   pure function solve_positive(factor, right) result(x)
      real(wp), intent(in) :: factor(6, 6), right(6)
      real(wp) :: x(6)
      integer :: i

      do i = 1, 6
         x(i) = (right(i) - sum(factor(i, :i - 1)*x(:i - 1)))/factor(i, i)
      end do
      do i = 6, 1, -1
         x(i) = (x(i) - sum(factor(i + 1:, i)*x(i + 1:)))/factor(i, i)
      end do
   end function solve_positive
end module lopin_kelvin
