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
module lopin_solid_finite
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_element_type, only : element_type, element_kind
   use lopin_dilatation, only : dilatation_count, dilatation_functions, projection
   use lopin_solid_small, only : gradients, fill_solid, fill_plane, add_product
   use lopin_solid_enhanced, only : enhanced_element, enhanced_deformation
   use lopin_finite_elastic, only : finite_law_type, finite_response, log_strain, &
      & thickness_change, condense_thickness, volume_change, flow_of_trial
   use lopin_radial_return, only : return_type
   use lopin_material_memory, only : past_of, metric_of, put_metric, pushed_metric, put_amplitudes, &
      & strain_at, stress_at, work_at
   implicit none
   private
   public :: finite_element, finite_stresses, finite_memory

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> Where the deformation has brought a Gauss point.
   type :: point_type
      real(wp) :: h(3, 3) = 0.0_wp          !! F - 1
      real(wp) :: change(3, 3) = 0.0_wp     !! b - 1, of the elastic part if no point flowed
      real(wp) :: own = 0.0_wp              !! J - 1
      real(wp) :: volume = 0.0_wp           !! J - 1 that counts: own, or projected
      real(wp) :: weight = 0.0_wp           !! reference volume
      real(wp) :: radius = 0.0_wp           !! deformed; axisymmetric only [length]
   end type point_type

contains

   !> Force, energy and, if asked for, tangent of an element.
   pure subroutine finite_element(element, law, x, u, thickness, memory, dt, force, energy, bad, &
      & ke)
      type(element_type), intent(in) :: element
      type(finite_law_type), intent(in) :: law
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) reference coordinates [length]
      real(wp), intent(in) :: u(:, :)        !! (ndim, nnode) displacements [length]
      real(wp), intent(in) :: thickness      !! plane kinds [length]
      real(wp), intent(in) :: memory(:, :)   !! (nmemory, ngauss) of the accepted state; (0, ngauss)
                                             !! if the law does not flow
      real(wp), intent(in) :: dt             !! since the accepted state [time]
      real(wp), intent(out) :: force(element%ndof)   !! internal forces [force]
      real(wp), intent(out) :: energy                !! [force length]
      integer, intent(out) :: bad            !! Gauss point turned inside out, else 0; then nothing
                                             !! else is defined
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)   !! [force/length]
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      real(wp) :: stress(element%nstress, element%ngauss), density
      real(wp) :: tangent(element%nstress, element%nstress, element%ngauss)
      integer :: k

      if (element%nmode > 0) then
         call enhanced_element(element, law, x, u, thickness, memory, dt, force, energy, bad, ke)
         return
      end if
      call deform(element, law, x, u, thickness, memory, dt, point, g, phi, bad)
      if (bad > 0) return
      energy = 0.0_wp
      do k = 1, element%ngauss
         if (present(ke)) then
            call finite_response(law, past_of(memory(:, k), element%nstress, dt), &
               & point(k)%change, point(k)%own, point(k)%volume, stress(:, k), density, &
               & tangent(:, :, k))
            if (element%kind == element_kind%plane_stress) call condense_thickness(tangent(:, :, k))
         else
            call finite_response(law, past_of(memory(:, k), element%nstress, dt), &
               & point(k)%change, point(k)%own, point(k)%volume, stress(:, k), density)
         end if
         energy = energy + point(k)%weight*density
      end do
      if (present(ke)) call tangent_of(element, point, g, phi, stress, tangent, ke)
      if (size(phi, 2) > 0) call share_pressure(point, phi, stress)
      call force_of(element, point, g, stress, force)
   end subroutine finite_element

   !> Cauchy stress and logarithmic strain (engineering shears) at the Gauss points, in the order
   !> xx yy zz xy xz yz.
   pure subroutine finite_stresses(element, law, x, u, thickness, memory, dt, stress, strain, bad)
      type(element_type), intent(in) :: element
      type(finite_law_type), intent(in) :: law
      real(wp), intent(in) :: x(:, :), u(:, :)               !! (ndim, nnode) [length]
      real(wp), intent(in) :: thickness                      !! plane kinds [length]
      real(wp), intent(in) :: memory(:, :)                   !! as for finite_element
      real(wp), intent(in) :: dt                             !! since the accepted state [time]
      real(wp), intent(out) :: stress(6, element%ngauss)     !! [stress]
      real(wp), intent(out) :: strain(6, element%ngauss)     !! [-]
      integer, intent(out) :: bad                            !! Gauss point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss), energy
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      integer :: k

      stress = 0.0_wp
      strain = 0.0_wp
      call deform(element, law, x, u, thickness, memory, dt, point, g, phi, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         call finite_response(law, past_of(memory(:, k), element%nstress, dt), point(k)%change, &
            & point(k)%own, point(k)%volume, stress(:element%nstress, k), energy)
         stress(:, k) = stress(:, k)/(1.0_wp + point(k)%volume)
         associate (h => point(k)%h)
            strain(:, k) = log_strain(h + transpose(h) + matmul(h, transpose(h)), point(k)%volume)
         end associate
      end do
   end subroutine finite_stresses

   !> The memory of this state, to be kept once it is accepted, plastic work since the last, volume.
   !>
   !> The metric changes by F**-1 (b after flow - b of the trial) F**-T. The work is that of the
   !> mean of the stresses before and after.
   pure subroutine finite_memory(element, law, x, u, thickness, dt, memory, work, held, bad)
      type(element_type), intent(in) :: element
      type(finite_law_type), intent(in) :: law
      real(wp), intent(in) :: x(:, :), u(:, :)               !! (ndim, nnode) [length]
      real(wp), intent(in) :: thickness                      !! plane kinds [length]
      real(wp), intent(in) :: dt                             !! since the accepted state [time]
      real(wp), intent(inout) :: memory(:, :)                !! of the accepted state, then of this
      real(wp), intent(out) :: work                          !! [force length]
      real(wp), intent(out) :: held                          !! deformed volume [length^3]
      integer, intent(out) :: bad                            !! Gauss point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      type(return_type) :: back
      real(wp) :: g(element%ndim, element%nnode, element%ngauss), taken(3, 3), inverse(3, 3), density
      real(wp) :: enhanced(3, 3, element%ngauss), alpha(element%nmode)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      integer :: k, m

      work = 0.0_wp
      held = 0.0_wp
      if (element%nmode > 0) then
         call enhanced_deformation(element, law, x, u, thickness, memory, dt, enhanced, alpha, bad)
         if (bad > 0) return
      end if
      call deform(element, law, x, u, thickness, memory, dt, point, g, phi, bad)
      if (bad > 0) return
      if (element%nmode > 0) call put_amplitudes(memory, element%nstress, alpha)
      held = sum(point%weight*(1.0_wp + point%own))
      m = element%nstress
      do k = 1, element%ngauss
         call flow_of_trial(law, past_of(memory(:, k), m, dt), point(k)%change, back, taken)
         if (.not. back%step > 0.0_wp) cycle
         inverse = inverse_of(point(k)%h)
         call put_metric(memory(:, k), m, metric_of(memory(:, k), m) &
            & + matmul(inverse, matmul(taken, transpose(inverse))))
         density = 0.5_wp*(memory(stress_at(m), k) + back%stress)*back%step
         memory(strain_at(m), k) = memory(strain_at(m), k) + back%step
         memory(stress_at(m), k) = back%stress
         memory(work_at(m), k) = memory(work_at(m), k) + density
         work = work + point(k)%weight*density
      end do
   end subroutine finite_memory

   !> (1 + h)**-1 of a regular deformation.
   pure function inverse_of(h) result(inverse)
      real(wp), intent(in) :: h(3, 3)
      real(wp) :: inverse(3, 3), f(3, 3)
      integer :: k

      f = h
      do k = 1, 3
         f(k, k) = f(k, k) + 1.0_wp
      end do
      inverse(1, :) = cross(f(:, 2), f(:, 3))
      inverse(2, :) = cross(f(:, 3), f(:, 1))
      inverse(3, :) = cross(f(:, 1), f(:, 2))
      inverse = inverse/dot_product(f(:, 1), inverse(1, :))
   end function inverse_of

   !> Gradients of the shape functions in the deformed place and the deformation of every point.
   pure subroutine deform(element, law, x, u, thickness, memory, dt, point, g, phi, bad)
      type(element_type), intent(in) :: element
      type(finite_law_type), intent(in) :: law
      real(wp), intent(in) :: x(:, :), u(:, :), thickness, memory(:, :), dt
      type(point_type), intent(out) :: point(element%ngauss)
      real(wp), intent(out) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp), intent(out) :: phi(element%ngauss, dilatation_count(element))
      integer, intent(out) :: bad
      real(wp) :: h(3, 3), determinant, radius, enhanced(3, 3, element%ngauss)
      real(wp) :: alpha(element%nmode)
      integer :: k, d, m

      d = element%ndim
      m = element%nnode
      if (element%nmode > 0) then
         call enhanced_deformation(element, law, x, u, thickness, memory, dt, enhanced, alpha, bad)
         if (bad > 0) return
      end if
      do bad = 1, element%ngauss
         k = bad
         call gradients(d, m, x, element%dn(:, :, k), g(:, :, k), determinant)
         if (.not. determinant > 0.0_wp) return
         h = 0.0_wp
         h(:d, :d) = matmul(u(:, :m), transpose(g(:, :, k)))
         point(k)%weight = element%weight(k)*determinant
         if (element%axisymmetric) then
            radius = dot_product(x(1, :m), element%n(:, k))
            h(3, 3) = dot_product(u(1, :m), element%n(:, k))/radius
            point(k)%radius = radius*(1.0_wp + h(3, 3))
            point(k)%weight = point(k)%weight*2.0_wp*pi*radius
            if (.not. point(k)%radius > 0.0_wp) return
         else if (d == 2) then
            point(k)%weight = point(k)%weight*thickness
         end if
         if (element%nmode > 0) h = enhanced(:, :, k)
         point(k)%change = h + transpose(h) + matmul(h, transpose(h))
         if (size(memory, 1) > 0) point(k)%change = point(k)%change &
            & + pushed_metric(h, memory(:, k), element%nstress)
         point(k)%own = volume_change(h)
         if (.not. 1.0_wp + point(k)%own > 0.0_wp) return
         call push_forward(d, m, h, g(:, :, k))
         if (element%kind == element_kind%plane_stress) then
            h(3, 3) = thickness_change(law, past_of(memory(:, k), element%nstress, 1.0_wp), &
               & point(k)%change, point(k)%own)
            point(k)%change(3, 3) = h(3, 3)*(2.0_wp + h(3, 3))
            point(k)%own = point(k)%own + h(3, 3)*(1.0_wp + point(k)%own)
         end if
         point(k)%h = h
      end do
      bad = 0
      point%volume = point%own
      if (size(phi, 2) == 0) return
      call dilatation_functions(element, x, point%weight, phi)
      point%volume = projection(phi, point%weight*point%own)
      bad = findloc(1.0_wp + point%volume > 0.0_wp, .false., dim=1)
   end subroutine deform

   !> g <- F**-T g with F = 1 + h, regular.
   pure subroutine push_forward(d, m, h, g)
      integer, intent(in) :: d, m
      real(wp), intent(in) :: h(3, 3)
      real(wp), intent(inout) :: g(d, m)
      real(wp) :: inverse(3, 3), old(3)
      integer :: a

      inverse = inverse_of(h)
      old = 0.0_wp
      do a = 1, m
         old(:d) = g(:, a)
         g(:, a) = matmul(old, inverse(:, :d))
      end do
   end subroutine push_forward

   !> The pressures of the points act on the projected volume ratio. The Kirchhoff stress that does
   !> the same work.
   pure subroutine share_pressure(point, phi, stress)
      type(point_type), intent(in) :: point(:)
      real(wp), intent(in) :: phi(:, :)
      real(wp), intent(inout) :: stress(:, :)
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
      real(wp), intent(in) :: phi(:, :)        !! (ngauss, dilatation_count)
      real(wp), intent(in) :: stress(:, :)     !! (nstress, ngauss)
      real(wp) :: shared(size(point))

      shared = (stress(1, :) + stress(2, :) + stress(3, :))/(3.0_wp*(1.0_wp + point%volume))
      shared = projection(phi, point%weight*shared)
   end function shared_pressure

   pure subroutine force_of(element, point, g, stress, force)
      type(element_type), intent(in) :: element
      type(point_type), intent(in) :: point(element%ngauss)
      real(wp), intent(in) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp), intent(in) :: stress(element%nstress, element%ngauss)
      real(wp), intent(out) :: force(element%ndim, element%nnode)
      real(wp) :: s(element%ndim, element%ndim)
      integer :: a, k

      force = 0.0_wp
      do k = 1, element%ngauss
         s = point(k)%weight*tensor(element%ndim, stress(:, k))
         do a = 1, element%nnode
            force(:, a) = force(:, a) + matmul(s, g(:, a, k))
         end do
         if (element%axisymmetric) force(1, :) = force(1, :) &
            & + (point(k)%weight*stress(3, k)/point(k)%radius)*element%n(:, k)
      end do
   end subroutine force_of

   !> In-plane or whole tensor of a stress.
   pure function tensor(d, stress) result(s)
      integer, intent(in) :: d
      real(wp), intent(in) :: stress(:)
      real(wp) :: s(d, d)

      s(1, 1) = stress(1)
      s(2, 2) = stress(2)
      s(1, 2) = stress(4)
      s(2, 1) = stress(4)
      if (d == 2) return
      s(3, 3) = stress(3)
      s(1, 3) = stress(5)
      s(3, 1) = stress(5)
      s(2, 3) = stress(6)
      s(3, 2) = stress(6)
   end function tensor

   !> The second derivative of the energy.
   pure subroutine tangent_of(element, point, g, phi, stress, tangent, ke)
      type(element_type), intent(in) :: element
      type(point_type), intent(in) :: point(element%ngauss)
      real(wp), intent(in) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp), intent(in) :: phi(:, :)                      !! (ngauss, dilatation_count)
      real(wp), intent(in) :: stress(element%nstress, element%ngauss)   !! Kirchhoff
      real(wp), intent(in) :: tangent(element%nstress, element%nstress, element%ngauss)
      real(wp), intent(out) :: ke(element%ndof, element%ndof)
      real(wp) :: b(element%ndof, element%nstress), c(element%nstress, element%nstress)
      real(wp) :: coupling(element%nstress), shared(element%ngauss), swap, corner
      real(wp) :: part(size(phi, 2)), corners(size(phi, 2), size(phi, 2))
      ! Slopes of the amplitudes of phi in the volume ratio; what couples with them.
      real(wp) :: theta(element%ndof, size(phi, 2)), mixed(element%ndof, size(phi, 2))
      integer :: i, k, m

      ke = 0.0_wp
      theta = 0.0_wp
      mixed = 0.0_wp
      corners = 0.0_wp
      shared = 0.0_wp
      if (size(phi, 2) > 0) shared = shared_pressure(point, phi, stress)
      do k = 1, element%ngauss
         call strain_rows(element, k, point(k), g(:, :, k), b)
         if (size(phi, 2) > 0) then
            call average_tangent(tangent(:, :, k), stress(:, k), shared(k), point(k), c, coupling, &
               & corner)
            part = phi(k, :)/(1.0_wp + point(k)%volume)
            swap = point(k)%weight*(1.0_wp + point(k)%own)
            do m = 1, size(phi, 2)
               mixed(:, m) = mixed(:, m) + part(m)*matmul(b, coupling)
               theta(:, m) = theta(:, m) + phi(k, m)*swap*(b(:, 1) + b(:, 2) + b(:, 3))
               corners(:, m) = corners(:, m) + part*corner*part(m)
            end do
            swap = point(k)%weight*((stress(1, k) + stress(2, k) + stress(3, k))/3.0_wp &
               & - shared(k)*(1.0_wp + point(k)%own))
         else
            c = point(k)%weight*tangent(:, :, k)
            swap = 0.0_wp
         end if
         call add_product(element%ndof, element%nstress, b, c, ke)
         call add_geometric(element, k, point(k), g(:, :, k), stress(:, k), swap, ke)
      end do
      mixed = mixed + 0.5_wp*matmul(theta, corners)
      do m = 1, size(phi, 2)
         do i = 1, element%ndof
            ke(i:, i) = ke(i:, i) + theta(i:, m)*mixed(i, m) + mixed(i:, m)*theta(i, m)
         end do
      end do
      do i = 2, element%ndof
         ke(:i - 1, i) = ke(i, :i - 1)
      end do
   end subroutine tangent_of

   !> Rates of deformation in the deformed place: the B matrix, dofs first.
   pure subroutine strain_rows(element, k, point, g, b)
      type(element_type), intent(in) :: element
      integer, intent(in) :: k
      type(point_type), intent(in) :: point
      real(wp), intent(in) :: g(element%ndim, element%nnode)
      real(wp), intent(out) :: b(element%ndof, element%nstress)

      if (element%ndim == 3) then
         call fill_solid(element%nnode, g, b)
      else
         call fill_plane(element%nnode, g, b)
         if (element%axisymmetric) b(1::2, 3) = element%n(:, k)/point%radius
      end if
   end subroutine strain_rows

   !> The rate of the scaled deformation is the deviator of the rate plus a third of the rate of
   !> ln v, v the volume ratio that counts. Quadratic form of the energy in both: `c` on the strain
   !> rows, `coupling` between them and ln v, `corner` on ln v, the change of the scaling included.
   pure subroutine average_tangent(tangent, stress, shared, point, c, coupling, corner)
      real(wp), intent(in) :: tangent(:, :), stress(:)
      real(wp), intent(in) :: shared           !! of shared_pressure
      type(point_type), intent(in) :: point
      real(wp), intent(out) :: c(:, :), coupling(:)
      real(wp), intent(out) :: corner
      real(wp) :: row(size(stress)), total, trace
      integer :: i

      row = tangent(:, 1) + tangent(:, 2) + tangent(:, 3)
      total = row(1) + row(2) + row(3)
      trace = stress(1) + stress(2) + stress(3)
      c = tangent
      do i = 1, 3
         c(:, i) = c(:, i) - row/3.0_wp - 2.0_wp/3.0_wp*stress
         c(i, :) = c(i, :) - row/3.0_wp - 2.0_wp/3.0_wp*stress
      end do
      c(:3, :3) = c(:3, :3) + total/9.0_wp + 2.0_wp/9.0_wp*trace + shared*(1.0_wp + point%own)
      c = point%weight*c
      coupling = row/3.0_wp + 2.0_wp/3.0_wp*stress
      coupling(:3) = coupling(:3) - total/9.0_wp - 2.0_wp/9.0_wp*trace
      coupling = point%weight*coupling
      corner = point%weight*((total + 2.0_wp*trace)/9.0_wp - trace/3.0_wp)
   end subroutine average_tangent

   !> Lower triangle: stress times the second variation of the place, and `swap` times the trace of
   !> the product of two velocity gradients.
   pure subroutine add_geometric(element, k, point, g, stress, swap, ke)
      type(element_type), intent(in) :: element
      integer, intent(in) :: k
      type(point_type), intent(in) :: point
      real(wp), intent(in) :: g(element%ndim, element%nnode)
      real(wp), intent(in) :: stress(:), swap
      real(wp), intent(inout) :: ke(element%ndof, element%ndof)
      real(wp) :: s(element%ndim, element%ndim), sg(element%ndim), value, hoop
      integer :: a, b, d, i, j, row, column

      d = element%ndim
      s = point%weight*tensor(d, stress)
      hoop = 0.0_wp
      if (element%axisymmetric) hoop = (point%weight*stress(3) + swap)/point%radius**2
      do b = 1, element%nnode
         sg = matmul(s, g(:, b))
         column = d*(b - 1)
         do a = b, element%nnode
            row = d*(a - 1)
            value = dot_product(g(:, a), sg)
            do i = 1, d
               ke(row + i, column + i) = ke(row + i, column + i) + value
            end do
            if (element%axisymmetric) ke(row + 1, column + 1) = ke(row + 1, column + 1) &
               & + hoop*element%n(a, k)*element%n(b, k)
            if (.not. abs(swap) > 0.0_wp) cycle
            do j = 1, d
               do i = 1, d
                  ke(row + i, column + j) = ke(row + i, column + j) + swap*g(j, a)*g(i, b)
               end do
            end do
         end do
      end do
   end subroutine add_geometric
end module lopin_solid_finite
