!> Volumes of the points at which an element is integrated.
module lopin_point_volumes
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_gradients, only : gradients
   implicit none
   private
   public :: point_volumes

   real(wp), parameter :: round = 2.0_wp*acos(-1.0_wp)

contains

   !> Of the Gauss points of an element at the start [length^3]; of whole rings.
   pure function point_volumes(element, x, thickness) result(volume)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(in) :: thickness        !! plane kinds [length]
      real(wp) :: volume(element%ngauss), g(element%ndim, element%nnode)
      integer :: k

      do k = 1, element%ngauss
         call gradients(element%ndim, element%nnode, x, element%dn(:, :, k), g, volume(k))
         volume(k) = volume(k)*element%weight(k)
         if (element%ndim == 3) cycle
         volume(k) = volume(k)*merge(round*dot_product(x(1, :), element%n(:, k)), &
            & thickness, element%axisymmetric)
      end do
   end function point_volumes
end module lopin_point_volumes
