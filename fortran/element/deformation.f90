!> Where displacements bring the Gauss points of a solid at finite strain.
!>
!> Strains keep all their digits where they are small: F - 1, b - 1 and J - 1 are computed as such.
module lopin_deformation
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_dilatation, only : dilatation_count, dilatation_functions, projection
   use lopin_solid_small, only : gradients
   use lopin_solid_enhanced, only : enhanced_deformation
   use lopin_finite_elastic, only : finite_law_type, past_type, thickness_change, volume_change
   use lopin_material_memory, only : past_of, trial_change
   implicit none
   private
   public :: point_type, deform, inverse_of

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> Where the deformation has brought a Gauss point.
   type :: point_type
      real(wp) :: h(3, 3)          !! F - 1
      real(wp) :: change(3, 3)     !! b - 1, of the elastic part if no point flowed
      real(wp) :: own              !! J - 1
      real(wp) :: volume           !! J - 1 that counts: own, or projected
      real(wp) :: weight           !! reference volume
   end type point_type

contains

   !> Gradients of the shape functions in the deformed place and the deformation of every point.
   pure subroutine deform(element, law, x, u, thickness, memory, dt, point, g, hoop, phi, bad)
      type(element_type), intent(in) :: element
      type(finite_law_type), intent(in) :: law
      real(wp), intent(in), dimension(element%ndim, element%nnode) :: x, u
      real(wp), contiguous, intent(in) :: memory(:, :)
      real(wp), intent(in) :: thickness, dt
      type(point_type), intent(out) :: point(element%ngauss)
      real(wp), intent(out) :: g(element%ndim, element%nnode, element%ngauss)   !! [1/length]
      real(wp), intent(out) :: hoop(element%nnode, element%ngauss)   !! shape functions per deformed
                                             !! radius; 0 unless axisymmetric [1/length]
      real(wp), intent(out) :: phi(element%ngauss, dilatation_count(element))
      integer, intent(out) :: bad
      real(wp) :: determinant, enhanced(3, 3, element%ngauss), alpha(element%nmode)
      integer :: k

      if (element%nmode > 0) then
         call enhanced_deformation(element, law, x, u, thickness, memory, dt, enhanced, alpha, bad)
         if (bad > 0) return
      end if
      do bad = 1, element%ngauss
         k = bad
         call gradients(element%ndim, element%nnode, x, element%dn(:, :, k), g(:, :, k), determinant)
         if (.not. determinant > 0.0_wp) return
         point(k)%weight = element%weight(k)*determinant
         call place(element, k, x, u, thickness, g(:, :, k), hoop(:, k), point(k))
         if (element%nmode > 0) point(k)%h = enhanced(:, :, k)
         if (.not. 1.0_wp + point(k)%h(3, 3) > 0.0_wp .and. element%ndim == 2) return
         point(k)%change = trial_change(point(k)%h, memory(:, k), element%nstress)
         point(k)%own = volume_change(point(k)%h)
         if (.not. 1.0_wp + point(k)%own > 0.0_wp) return
         call push_forward(element%ndim, element%nnode, point(k)%h, g(:, :, k), hoop(:, k))
         if (element%kind == element_kind%plane_stress) call stretch_thickness(law, &
            & past_of(memory(:, k), element%nstress, 1.0_wp), point(k))
         point(k)%volume = point(k)%own
      end do
      bad = 0
      if (size(phi, 2) == 0) return
      call dilatation_functions(element, x, point%weight, phi)
      point%volume = projection(phi, point%weight*point%own)
      bad = findloc(1.0_wp + point%volume > 0.0_wp, .false., dim=1)
   end subroutine deform

   !> Displacement gradient and reference volume of a point, and its hoop row.
   pure subroutine place(element, k, x, u, thickness, g, hoop, point)
      type(element_type), intent(in) :: element
      integer, intent(in) :: k
      real(wp), intent(in), dimension(element%ndim, element%nnode) :: x, u
      real(wp), intent(in) :: thickness
      real(wp), intent(in) :: g(element%ndim, element%nnode)   !! in the reference shape [1/length]
      real(wp), intent(out) :: hoop(element%nnode)             !! the same
      type(point_type), intent(inout) :: point     !! its weight is that of the plane or of space
      real(wp) :: radius
      integer :: a, j

      point%h = 0.0_wp
      hoop = 0.0_wp
      if (element%ndim == 3) then
         do a = 1, element%nnode
            do j = 1, 3
               point%h(:, j) = point%h(:, j) + u(:3, a)*g(j, a)
            end do
         end do
         return
      end if
      do a = 1, element%nnode
         do j = 1, 2
            point%h(:2, j) = point%h(:2, j) + u(:2, a)*g(j, a)
         end do
      end do
      if (.not. element%axisymmetric) then
         point%weight = point%weight*thickness
         return
      end if
      radius = dot_product(x(1, :), element%n(:, k))
      hoop = element%n(:, k)/radius
      point%h(3, 3) = dot_product(u(1, :), hoop)
      point%weight = point%weight*2.0_wp*pi*radius
   end subroutine place

   !> g <- F**-T g with F = 1 + h, regular; the same with the hoop row.
   pure subroutine push_forward(d, m, h, g, hoop)
      integer, intent(in) :: d, m
      real(wp), intent(in) :: h(3, 3)
      real(wp), intent(inout) :: g(d, m), hoop(m)
      real(wp) :: f(3, 3), old(3)
      integer :: a

      f = inverse_of(h)
      if (d == 2) then
         do a = 1, m
            old(:2) = g(:2, a)
            g(1, a) = f(1, 1)*old(1) + f(2, 1)*old(2)
            g(2, a) = f(1, 2)*old(1) + f(2, 2)*old(2)
            hoop(a) = f(3, 3)*hoop(a)
         end do
      else
         do a = 1, m
            old = g(:3, a)
            g(1, a) = f(1, 1)*old(1) + f(2, 1)*old(2) + f(3, 1)*old(3)
            g(2, a) = f(1, 2)*old(1) + f(2, 2)*old(2) + f(3, 2)*old(3)
            g(3, a) = f(1, 3)*old(1) + f(2, 3)*old(2) + f(3, 3)*old(3)
         end do
      end if
   end subroutine push_forward

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

   !> Plane stress: the stretch through the thickness at which there is no stress across it.
   pure subroutine stretch_thickness(law, past, point)
      type(finite_law_type), intent(in) :: law
      type(past_type), intent(in) :: past
      type(point_type), intent(inout) :: point
      real(wp) :: h

      h = thickness_change(law, past, point%change, point%own)
      point%change(3, 3) = h*(2.0_wp + h)
      point%own = point%own + h*(1.0_wp + point%own)
      point%h(3, 3) = h
   end subroutine stretch_thickness
end module lopin_deformation
