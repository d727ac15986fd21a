!> Short vectors: cross products, normals and norms used on several floors.
module lopin_vectors
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_kinds, only : wp
   implicit none
   private
   public :: cross, across, largest, inverse_of

contains

   !> a x b.
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> A unit vector across a unit axis.
   pure function across(axis) result(t)
      real(wp), intent(in) :: axis(3)
      real(wp) :: t(3)

      t = 0.0_wp
      t(minloc(abs(axis), dim=1)) = 1.0_wp
      t = t - dot_product(t, axis)*axis
      t = t/norm2(t)
   end function across

   !> Largest size of an entry; zero of an empty list. NaN if an entry is: maxval passes over it.
   !>
   !> Without their sign the bits of real numbers follow each other as their sizes do, NaN last.
   pure real(wp) function largest(x)
      real(wp), intent(in) :: x(:)
      integer, parameter :: lanes = 4
      integer(int64), parameter :: unsigned = huge(0_int64)
      integer(int64) :: most(lanes)
      integer :: i, k

      most = 0_int64
      do i = 1, size(x) - lanes + 1, lanes
         do k = 1, lanes
            most(k) = max(most(k), iand(transfer(x(i + k - 1), most(k)), unsigned))
         end do
      end do
      do i = size(x) - mod(size(x), lanes) + 1, size(x)
         most(1) = max(most(1), iand(transfer(x(i), most(1)), unsigned))
      end do
      largest = transfer(maxval(most), largest)
   end function largest

   !> (1 + h)**-1 of a regular deformation.
   pure function inverse_of(h) result(inverse)
      real(wp), intent(in) :: h(3, 3)
      real(wp) :: inverse(3, 3), f(3, 3)
      integer :: k

      f = h
      do k = 1, 3
         f(k, k) = f(k, k) + 1.0_wp
      end do
      inverse(1, 1) = f(2, 2)*f(3, 3) - f(3, 2)*f(2, 3)
      inverse(2, 1) = f(3, 1)*f(2, 3) - f(2, 1)*f(3, 3)
      inverse(3, 1) = f(2, 1)*f(3, 2) - f(3, 1)*f(2, 2)
      inverse(1, 2) = f(3, 2)*f(1, 3) - f(1, 2)*f(3, 3)
      inverse(2, 2) = f(1, 1)*f(3, 3) - f(3, 1)*f(1, 3)
      inverse(3, 2) = f(3, 1)*f(1, 2) - f(1, 1)*f(3, 2)
      inverse(1, 3) = f(1, 2)*f(2, 3) - f(2, 2)*f(1, 3)
      inverse(2, 3) = f(2, 1)*f(1, 3) - f(1, 1)*f(2, 3)
      inverse(3, 3) = f(1, 1)*f(2, 2) - f(2, 1)*f(1, 2)
      inverse = inverse*(1.0_wp/(f(1, 1)*inverse(1, 1) + f(2, 1)*inverse(1, 2) &
         & + f(3, 1)*inverse(1, 3)))
   end function inverse_of
end module lopin_vectors
