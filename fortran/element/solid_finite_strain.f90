!> Solids at finite strain: internal force, consistent tangent, energy and stress of one element.
!>
!> Total displacements and the memory of the accepted state in, nothing else; the memory of the next
!> one is asked for when it is accepted. Integration is over the reference volume, stress is
!> Kirchhoff stress, gradients are taken in the deformed place.
!>
!> Mean dilatation (Q1P0; Nagtegaal 1974, Simo 1985): the deformation gradient of a point is scaled
!> to the volume ratio of the element, v/V, or to the linear part of the volume ratios of its points
!> (module dilatation), and the energy is that of the scaled one. Force and tangent are its exact
!> derivatives, so the tangent is symmetric; for vanishing displacements it is the B-bar element of
!> small strain.
!>
!> Plane stress: the stretch through the thickness follows from the law at each point.
module lopin_solid_finite_strain
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type
   use lopin_dilatation, only : dilatation_count, projection
   use lopin_deformation, only : deform
   use lopin_material_point, only : point_type, respond_at, keep_at
   use lopin_velocity_form, only : velocity_form, add_force, add_stiffness
   use lopin_solid_enhanced, only : enhanced_element
   use lopin_hyperelastic, only : log_strain, total_change, condense_thickness, elastic_constants
   use lopin_hourglass, only : add_hourglass, moduli_type
   use lopin_material_memory, only : put_amplitudes
   implicit none
   private
   public :: finite_strain_element, finite_strain_stresses, finite_strain_memory

contains

   !> Force, energy and, if asked for, tangent of an element.
   pure subroutine finite_strain_element(element, input, force, energy, bad, ke)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: force(element%ndof)   !! internal forces [force]
      real(wp), intent(out) :: energy                !! [force length]
      integer, intent(out) :: bad            !! Gauss point turned inside out, else 0; then nothing
                                             !! else is defined
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)   !! [force/length]
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp) :: hoop(element%nnode, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      real(wp) :: stress(element%nstress, element%ngauss), density
      type(moduli_type) :: moduli
      real(wp) :: tangent(element%nstress, element%nstress, element%ngauss)
      integer :: k
      logical :: found

      if (element%nmode > 0) then
         call enhanced_element(element, input, force, energy, bad, ke)
         return
      end if
      call deform(element, input, point, g, hoop, phi, bad)
      if (bad > 0) return
      energy = 0.0_wp
      do k = 1, element%ngauss
         if (present(ke)) then
            call respond_at(input%law, point(k), input%memory(:, k), input%dt, stress(:, k), &
               & density, found, tangent(:, :, k))
            if (element%kind == element_kind%plane_stress) call condense_thickness(tangent(:, :, k))
         else
            call respond_at(input%law, point(k), input%memory(:, k), input%dt, stress(:, k), &
               & density, found)
         end if
         if (.not. found) then
            bad = k
            return
         end if
         energy = energy + point(k)%weight*density
      end do
      if (present(ke)) call tangent_of(element, point, g, hoop, phi, stress, tangent, ke)
      if (size(phi, 2) > 0) call share_pressure(point, phi, stress)
      force = 0.0_wp
      do k = 1, element%ngauss
         call add_force(element%ndim, element%nnode, g(:, :, k), hoop(:, k), stress(:, k), &
            & point(k)%weight, force)
      end do
      if (.not. element%hourglass) return
      moduli%thickness = input%thickness
      call elastic_constants(input%law, moduli%young, moduli%poisson)
      call add_hourglass(element, moduli, input%x, input%u, .true., force, energy, ke)
   end subroutine finite_strain_element

   !> Cauchy stress and logarithmic strain (engineering shears) at the Gauss points, in the order
   !> xx yy zz xy xz yz.
   pure subroutine finite_strain_stresses(element, input, stress, strain, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: stress(6, element%ngauss)     !! [stress]
      real(wp), intent(out) :: strain(6, element%ngauss)     !! [-]
      integer, intent(out) :: bad                            !! Gauss point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss), energy
      real(wp) :: hoop(element%nnode, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      integer :: k
      logical :: found

      stress = 0.0_wp
      strain = 0.0_wp
      call deform(element, input, point, g, hoop, phi, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         call respond_at(input%law, point(k), input%memory(:, k), input%dt, &
            & stress(:element%nstress, k), energy, found)
         stress(:, k) = stress(:, k)/(1.0_wp + point(k)%volume)
         strain(:, k) = log_strain(total_change(point(k)%h), point(k)%volume)
      end do
   end subroutine finite_strain_stresses

   !> The memory of this state, to be kept once it is accepted, plastic work since the last, volume.
   pure subroutine finite_strain_memory(element, input, next, work, held, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), contiguous, intent(inout) :: next(:, :)      !! memory: a copy of that of the
                                                             !! accepted state, then of this
      real(wp), intent(out) :: work                          !! [force length]
      real(wp), intent(out) :: held                          !! deformed volume [length^3]
      integer, intent(out) :: bad                            !! Gauss point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp) :: hoop(element%nnode, element%ngauss)
      real(wp) :: density
      real(wp) :: alpha(element%nmode)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      integer :: k

      work = 0.0_wp
      held = 0.0_wp
      call deform(element, input, point, g, hoop, phi, bad, alpha)
      if (bad > 0) return
      if (element%nmode > 0) call put_amplitudes(next, element%nstress, alpha)
      held = sum(point%weight*(1.0_wp + point%own))
      do k = 1, element%ngauss
         call keep_at(input%law, point(k), element%nstress, input%dt, next(:, k), density)
         work = work + point(k)%weight*density
      end do
   end subroutine finite_strain_memory

   !> The pressures of the points act on the projected volume ratio. The Kirchhoff stress that does
   !> the same work.
   pure subroutine share_pressure(point, phi, stress)
      type(point_type), intent(in) :: point(:)
      real(wp), contiguous, intent(in) :: phi(:, :)
      real(wp), contiguous, intent(inout) :: stress(:, :)
      real(wp) :: own, shared(size(point))
      integer :: k

      shared = shared_pressure(point, phi, stress)
      do k = 1, size(point)
         own = (stress(1, k) + stress(2, k) + stress(3, k))/3.0_wp
         stress(:3, k) = stress(:3, k) - own + shared(k)*(1.0_wp + point(k)%own)
      end do
   end subroutine share_pressure

   !> Projection of the Kirchhoff pressure (tension positive) per volume ratio that counts.
   pure function shared_pressure(point, phi, stress) result(shared)
      type(point_type), intent(in) :: point(:)
      real(wp), contiguous, intent(in) :: phi(:, :)        !! (ngauss, dilatation_count)
      real(wp), contiguous, intent(in) :: stress(:, :)     !! (nstress, ngauss)
      real(wp) :: shared(size(point))

      shared = (stress(1, :) + stress(2, :) + stress(3, :))/(3.0_wp*(1.0_wp + point%volume))
      shared = projection(phi, point%weight*shared)
   end function shared_pressure

   !> The second derivative of the energy.
   pure subroutine tangent_of(element, point, g, hoop, phi, stress, tangent, ke)
      type(element_type), intent(in) :: element
      type(point_type), intent(in) :: point(element%ngauss)
      real(wp), intent(in) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp), intent(in) :: hoop(element%nnode, element%ngauss)
      real(wp), contiguous, intent(in) :: phi(:, :)          !! (ngauss, dilatation_count)
      real(wp), intent(in) :: stress(element%nstress, element%ngauss)   !! Kirchhoff
      real(wp), intent(inout) :: tangent(element%nstress, element%nstress, element%ngauss)
      real(wp), intent(out) :: ke(element%ndof, element%ndof)
      real(wp) :: coupling(element%nstress), shared(element%ngauss), swap, corner, q(9, 9)
      real(wp), dimension(element%ndof) :: row, dilation
      real(wp) :: part(size(phi, 2)), corners(size(phi, 2), size(phi, 2))
      ! Slopes of the amplitudes of phi in the volume ratio; what couples with them.
      real(wp) :: theta(element%ndof, size(phi, 2)), mixed(element%ndof, size(phi, 2))
      real(wp), parameter :: unit(6) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      integer :: i, k, m

      ke = 0.0_wp
      theta = 0.0_wp
      mixed = 0.0_wp
      corners = 0.0_wp
      shared = 0.0_wp
      if (size(phi, 2) > 0) shared = shared_pressure(point, phi, stress)
      do k = 1, element%ngauss
         associate (own => 1.0_wp + point(k)%own, weight => point(k)%weight)
            swap = 0.0_wp
            if (size(phi, 2) > 0) then
               call average_tangent(tangent(:, :, k), stress(:, k), shared(k)*own, coupling, corner)
               swap = (stress(1, k) + stress(2, k) + stress(3, k))/3.0_wp - shared(k)*own
               row = 0.0_wp
               dilation = 0.0_wp
               call add_force(element%ndim, element%nnode, g(:, :, k), hoop(:, k), coupling, &
                  & weight, row)
               call add_force(element%ndim, element%nnode, g(:, :, k), hoop(:, k), unit, &
                  & weight*own, dilation)
               part = phi(k, :)/(1.0_wp + point(k)%volume)
               do m = 1, size(phi, 2)
                  mixed(:, m) = mixed(:, m) + part(m)*row
                  theta(:, m) = theta(:, m) + phi(k, m)*dilation
                  corners(:, m) = corners(:, m) + (weight*corner*part(m))*part
               end do
            end if
            call velocity_form(element%ndim, stress(:, k), tangent(:, :, k), swap, weight, q)
         end associate
         call add_stiffness(element%ndim, element%nnode, g(:, :, k), hoop(:, k), q, ke)
      end do
      if (size(phi, 2) > 0) call add_coupling(theta, mixed, corners, ke)
      do i = 2, element%ndof
         ke(:i - 1, i) = ke(i, :i - 1)
      end do
   end subroutine tangent_of

   !> What the volume ratio that counts adds: its amplitudes with the strain rows and with each
   !> other.
   pure subroutine add_coupling(theta, mixed, corners, ke)
      real(wp), contiguous, intent(in) :: theta(:, :)     !! (ndof, dilatation_count) slopes
      real(wp), contiguous, intent(in) :: mixed(:, :)     !! (ndof, dilatation_count)
      real(wp), contiguous, intent(in) :: corners(:, :)   !! (dilatation_count, dilatation_count)
      real(wp), contiguous, intent(inout) :: ke(:, :)
      real(wp) :: whole(size(ke, 1))
      integer :: i, l, m

      do m = 1, size(theta, 2)
         whole = mixed(:, m)
         do l = 1, size(theta, 2)
            whole = whole + (0.5_wp*corners(l, m))*theta(:, l)
         end do
         do i = 1, size(ke, 1)
            ke(:, i) = ke(:, i) + theta(:, m)*whole(i) + whole*theta(i, m)
         end do
      end do
   end subroutine add_coupling

   !> The rate of the scaled deformation is the deviator of the rate plus a third of the rate of
   !> ln v, v the volume ratio that counts. Quadratic form of the energy in both, the change of the
   !> scaling included: on the strain rows (in the place of the tangent), between them and ln v, and
   !> on ln v.
   pure subroutine average_tangent(tangent, stress, pressure, coupling, corner)
      real(wp), contiguous, intent(inout) :: tangent(:, :)   !! (nstress, nstress) [stress]
      real(wp), contiguous, intent(in) :: stress(:)          !! (nstress) [stress]
      real(wp), intent(in) :: pressure         !! Kirchhoff pressure of shared_pressure [stress]
      real(wp), contiguous, intent(out) :: coupling(:)       !! (nstress) [stress]
      real(wp), intent(out) :: corner          !! [stress]
      real(wp) :: total, trace
      integer :: i, j

      coupling = tangent(:, 1) + tangent(:, 2) + tangent(:, 3)
      total = coupling(1) + coupling(2) + coupling(3)
      trace = stress(1) + stress(2) + stress(3)
      coupling = coupling/3.0_wp + 2.0_wp/3.0_wp*stress
      do j = 1, 3
         do i = 1, 3
            tangent(i, j) = tangent(i, j) - coupling(i) - coupling(j) &
               & + ((total + 2.0_wp*trace)/9.0_wp + pressure)
         end do
      end do
      do j = 4, size(stress)
         tangent(:3, j) = tangent(:3, j) - coupling(j)
         tangent(j, :3) = tangent(:3, j)
      end do
      coupling(:3) = coupling(:3) - (total + 2.0_wp*trace)/9.0_wp
      corner = (total - trace)/9.0_wp
   end subroutine average_tangent
end module lopin_solid_finite_strain
