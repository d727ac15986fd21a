!> Deformation of the Gauss points of a solid at finite strain.
!>
!> Strains keep all their digits where they are small: F - 1, b - 1 and J - 1 are computed as such.
module lopin_deformation
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type, counted_volume
   use lopin_dilatation, only : dilatation_count, dilatation_functions, projection
   use lopin_gradients, only : all_gradients, correct_ring_means
   use lopin_solid_enhanced, only : enhanced_deformation
   use lopin_vectors, only : inverse_of
   use lopin_hyperelastic, only : volume_change
   use lopin_material_memory, only : trial_change
   use lopin_material_point, only : point_type, stretch_thickness
   implicit none
   private
   public :: deform

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Gradients of the shape functions in the deformed place and the deformation of every point.
   pure subroutine deform(element, input, point, g, hoop, phi, bad, amplitudes)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(point_type), intent(out) :: point(element%ngauss)
      real(wp), intent(out) :: g(element%ndim, element%nnode, element%ngauss)   !! [1/length]
      real(wp), intent(out) :: hoop(element%nnode, element%ngauss)   !! shape functions per deformed
                                             !! radius; 0 unless axisymmetric [1/length]
      real(wp), intent(out) :: phi(element%ngauss, dilatation_count(element))
      integer, intent(out) :: bad
      real(wp), intent(out), optional :: amplitudes(element%nmode)   !! of the internal modes [-]
      real(wp) :: enhanced(3, 3, element%ngauss), alpha(element%nmode)
      integer :: k
      logical :: found

      if (element%nmode > 0) then
         call enhanced_deformation(element, input, enhanced, alpha, bad)
         if (bad > 0) return
         if (present(amplitudes)) amplitudes = alpha
      end if
      call all_gradients(element, input%x, g, point%weight, bad)
      if (bad > 0) return
      hoop = 0.0_wp
      if (element%axisymmetric) then
         call correct_ring_means(element, input%x, g, point%weight, hoop(:, 1))
         hoop = spread(hoop(:, 1), 2, element%ngauss)
      end if
      if (input%scaled) point%weight = point%weight*input%memory(size(input%memory, 1), :)
      do bad = 1, element%ngauss
         k = bad
         if (element%ndim == 2) then
            call place_in_plane(element, k, input, g(:, :, k), hoop(:, k), point(k))
         else
            call place_in_space(element%nnode, input%u, g(:, :, k), point(k)%h)
         end if
         if (element%nmode > 0) point(k)%h = enhanced(:, :, k)
         call trial_change(point(k)%h, input%memory(:, k), element%nstress, point(k)%change)
         point(k)%own = counted_volume(input, k, volume_change(point(k)%h))
         if (.not. 1.0_wp + point(k)%own > 0.0_wp) return
         if (element%ndim == 2) then
            if (.not. 1.0_wp + point(k)%h(3, 3) > 0.0_wp) return
            call push_in_plane(element%nnode, point(k)%h, g(:, :, k), hoop(:, k))
         else
            call push_in_space(element%nnode, point(k)%h, g(:, :, k))
         end if
         if (element%kind == element_kind%plane_stress) then
            call stretch_thickness(input%law, input%memory(:, k), element%nstress, input%dt, &
               & point(k), found)
            if (.not. found) return
         end if
         point(k)%volume = point(k)%own
      end do
      bad = 0
      if (size(phi, 2) == 0) return
      call dilatation_functions(element, input%x, point%weight, phi)
      point%volume = projection(phi, point%weight*point%own)
      bad = findloc(1.0_wp + point%volume > 0.0_wp, .false., dim=1)
   end subroutine deform

   !> Displacement gradient and reference volume of a point, and its hoop row.
   pure subroutine place_in_plane(element, k, input, g, hoop, point)
      type(element_type), intent(in) :: element
      integer, intent(in) :: k
      type(element_input_type), intent(in) :: input
      real(wp), intent(in) :: g(2, element%nnode)      !! in the reference shape [1/length]
      real(wp), intent(inout) :: hoop(element%nnode)   !! the same; what it corrects when entered
      type(point_type), intent(inout) :: point         !! its weight is an area
      real(wp) :: h(2, 2), radius
      integer :: a

      h = 0.0_wp
      radius = 0.0_wp
      do a = 1, element%nnode
         h(:, 1) = h(:, 1) + input%u(:, a)*g(1, a)
         h(:, 2) = h(:, 2) + input%u(:, a)*g(2, a)
         radius = radius + input%x(1, a)*element%n(a, k)
      end do
      point%h = 0.0_wp
      point%h(:2, :2) = h
      if (.not. element%axisymmetric) then
         hoop = 0.0_wp
         point%weight = point%weight*input%thickness
         return
      end if
      point%weight = point%weight*2.0_wp*pi*radius
      radius = 1.0_wp/radius
      do a = 1, element%nnode
         hoop(a) = hoop(a) + element%n(a, k)*radius
         point%h(3, 3) = point%h(3, 3) + input%u(1, a)*hoop(a)
      end do
   end subroutine place_in_plane

   !> Displacement gradient of a point.
   pure subroutine place_in_space(nnode, u, g, h)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: u(3, nnode), g(3, nnode)   !! in the reference shape [1/length]
      real(wp), intent(out) :: h(3, 3)
      integer :: a

      h = 0.0_wp
      do a = 1, nnode
         h(:, 1) = h(:, 1) + u(:, a)*g(1, a)
         h(:, 2) = h(:, 2) + u(:, a)*g(2, a)
         h(:, 3) = h(:, 3) + u(:, a)*g(3, a)
      end do
   end subroutine place_in_space

   !> g <- F**-T g with F = 1 + h, regular; the same with the hoop row.
   pure subroutine push_in_plane(nnode, h, g, hoop)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: h(3, 3)
      real(wp), intent(inout) :: g(2, nnode), hoop(nnode)
      real(wp) :: area, one(2), two(2), across   ! columns of F**-T
      integer :: a

      area = 1.0_wp/((1.0_wp + h(1, 1))*(1.0_wp + h(2, 2)) - h(1, 2)*h(2, 1))
      one = [area*(1.0_wp + h(2, 2)), -area*h(1, 2)]
      two = [-area*h(2, 1), area*(1.0_wp + h(1, 1))]
      across = 1.0_wp/(1.0_wp + h(3, 3))
      do a = 1, nnode
         g(:, a) = one*g(1, a) + two*g(2, a)
         hoop(a) = across*hoop(a)
      end do
   end subroutine push_in_plane

   pure subroutine push_in_space(nnode, h, g)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: h(3, 3)
      real(wp), intent(inout) :: g(3, nnode)
      real(wp) :: f(3, 3)
      integer :: a

      f = transpose(inverse_of(h))
      do a = 1, nnode
         g(:, a) = f(:, 1)*g(1, a) + f(:, 2)*g(2, a) + f(:, 3)*g(3, a)
      end do
   end subroutine push_in_space
end module lopin_deformation
