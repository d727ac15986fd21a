!> Enhanced linear quads and bricks at finite strain: they bend without shear or thickness locking.
!>
!> The deformation gradient of a point is F + F0 E(alpha), see module enhanced_modes. The amplitudes
!> alpha make the energy stationary at given displacements: a local Newton iteration finds them at
!> every call, from zero in an elastic solid, from those of the accepted state where it flows. So
!> the force is the slope of an energy of the displacements alone, and the tangent is the exact one,
!> symmetric.
!>
!> A generalised displacement (node or amplitude) has at each point a velocity gradient l, listed as
!> in module velocity_form.
module lopin_solid_enhanced
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type, counted_volume
   use lopin_enhanced_modes, only : modes_type, internal_modes, solve_small, most_modes, &
      & most_nodes, most_points
   use lopin_gradients, only : gradients
   use lopin_velocity_form, only : velocity_form, listed, tensor_of
   use lopin_hyperelastic, only : condense_thickness, volume_change
   use lopin_material_memory, only : trial_change, amplitudes_of, offset_at
   use lopin_material_point, only : point_type, respond_at, stretch_thickness
   implicit none
   private
   public :: enhanced_element, enhanced_deformation

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> What the nodes do, and the modes.
   type :: motion_type
      type(modes_type) :: modes
      real(wp) :: g(3, most_nodes, most_points)   !! reference slopes [1/length]
      real(wp) :: hoop(most_nodes, most_points)   !! shape function per radius [1/length]
      real(wp) :: weight(most_points)             !! reference volume
      real(wp) :: h(3, 3, most_points)            !! F - 1
      real(wp) :: centre(3, 3)                    !! F0
      real(wp) :: e(3, 3, most_modes, most_points)   !! F0 times the modes
   end type motion_type

   !> Answer of the material at a point.
   type :: answer_type
      real(wp) :: h(3, 3) = 0.0_wp          !! enhanced F - 1
      real(wp) :: inverse(3, 3) = 0.0_wp    !! of the enhanced F
      real(wp) :: s(3, 3) = 0.0_wp          !! Kirchhoff stress times volume
      real(wp) :: a(9, 9) = 0.0_wp          !! quadratic form on velocity gradients, times volume
      real(wp) :: energy = 0.0_wp
      logical :: bad = .false.              !! turned inside out
   end type answer_type


contains

   !> Force, energy and, if asked for, tangent of an element.
   pure subroutine enhanced_element(element, input, force, energy, bad, ke)
      type(element_type), intent(in) :: element    !! with nmode > 0
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: force(element%ndof)
      real(wp), intent(out) :: energy
      integer, intent(out) :: bad                  !! Gauss point turned inside out, else 0
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)
      type(motion_type) :: motion
      type(answer_type) :: answer
      real(wp), dimension(element%ndof + element%nmode, element%ndof + element%nmode) :: whole
      real(wp) :: alpha(element%nmode), residual(element%ndof + element%nmode)
      real(wp) :: own(element%nmode, element%nmode), follow(element%nmode, element%ndof)
      real(wp) :: l(element%ndof + element%nmode, 9)
      integer :: k, n
      logical :: regular

      call move(element, input, motion, bad)
      if (bad > 0) return
      call relax(element, input, motion, alpha, bad)
      if (bad > 0) return
      n = element%ndof
      energy = 0.0_wp
      residual = 0.0_wp
      whole = 0.0_wp
      do k = 1, element%ngauss
         call respond(element, input, motion, k, alpha, answer)
         energy = energy + answer%energy
         call node_rows(element, motion, k, alpha, answer, l(:n, :))
         call mode_rows(element, motion, k, answer, l(n + 1:, :))
         residual = residual + matmul(l, listed(element%ndim, answer%s))
         if (.not. present(ke)) cycle
         whole = whole + matmul(l, matmul(answer%a, transpose(l)))
         call add_swap(element, motion, k, answer, whole(:n, n + 1:))
      end do
      force = residual(:n)
      if (.not. present(ke)) return
      own = whole(n + 1:, n + 1:)
      follow = transpose(whole(:n, n + 1:))
      call solve_small(own, follow, regular)
      ke = whole(:n, :n) - matmul(whole(:n, n + 1:), follow)
      do k = 2, n
         ke(:k - 1, k) = ke(k, :k - 1)
      end do
   end subroutine enhanced_element

   !> Enhanced F - 1 at the Gauss points.
   pure subroutine enhanced_deformation(element, input, h, alpha, bad)
      type(element_type), intent(in) :: element    !! with nmode > 0
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: h(3, 3, element%ngauss)
      real(wp), intent(out) :: alpha(element%nmode)   !! amplitudes [-]
      integer, intent(out) :: bad                  !! Gauss point turned inside out, else 0
      type(motion_type) :: motion
      integer :: k

      h = 0.0_wp
      alpha = 0.0_wp
      call move(element, input, motion, bad)
      if (bad > 0) return
      call relax(element, input, motion, alpha, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         h(:, :, k) = motion%h(:, :, k) + summed(element, motion%e, k, alpha)
      end do
   end subroutine enhanced_deformation

   !> Displacement gradients of the nodes.
   pure subroutine move(element, input, motion, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(out) :: motion
      integer, intent(out) :: bad
      real(wp) :: determinant, radius
      integer :: d, k, m

      d = element%ndim
      m = element%nnode
      bad = 1
      call internal_modes(element, input%x, motion%modes, determinant)
      if (.not. determinant > 0.0_wp) return
      bad = 0
      motion%h(:, :, :element%ngauss) = 0.0_wp
      motion%hoop(:, :element%ngauss) = 0.0_wp
      do k = 1, element%ngauss
         call gradients(d, m, input%x, element%dn(:, :, k), motion%g(:d, :m, k), determinant)
         motion%weight(k) = element%weight(k)*determinant
         motion%h(:d, :d, k) = matmul(input%u(:, :m), transpose(motion%g(:d, :m, k)))
         if (element%axisymmetric) then
            radius = dot_product(input%x(1, :m), element%n(:, k))
            motion%hoop(:m, k) = element%n(:, k)/radius
            motion%h(3, 3, k) = dot_product(input%u(1, :m), motion%hoop(:m, k))
            motion%weight(k) = motion%weight(k)*2.0_wp*pi*radius
         else if (d == 2) then
            motion%weight(k) = motion%weight(k)*input%thickness
         end if
         if (input%scaled) motion%weight(k) = motion%weight(k) &
            & *input%memory(size(input%memory, 1), k)
      end do
      motion%centre = 0.0_wp
      motion%centre(:d, :d) = matmul(input%u(:, :m), transpose(motion%modes%g(:d, :m)))
      if (d == 2) motion%centre(3, 3) = dot_product(input%u(1, :m), motion%modes%hoop(:m))
      do k = 1, 3
         motion%centre(k, k) = motion%centre(k, k) + 1.0_wp
      end do
      do k = 1, element%ngauss
         do m = 1, element%nmode
            motion%e(:, :, m, k) = matmul(motion%centre, motion%modes%e(:, :, m, k))
         end do
      end do
   end subroutine move

   !> Amplitudes that make the energy stationary.
   pure subroutine relax(element, input, motion, alpha, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      real(wp), intent(out) :: alpha(element%nmode)
      integer, intent(out) :: bad
      real(wp), dimension(element%nmode, 1) :: force, step
      real(wp) :: pivot(element%nmode, element%nmode), size_of
      integer, parameter :: most = 60
      integer :: sweep
      logical :: regular

      alpha = amplitudes_of(input%memory, element%nstress, element%nmode)
      size_of = max(maxval(abs(motion%h(:, :, :element%ngauss))), &
         & strained(input%memory, element%nstress))
      call balance(element, input, motion, alpha, force, pivot, bad)
      if (bad > 0 .and. any(abs(alpha) > 0.0_wp)) then
         alpha = 0.0_wp
         call balance(element, input, motion, alpha, force, pivot, bad)
      end if
      do sweep = 1, most
         if (bad > 0) return
         step = force
         call solve_small(pivot, step, regular)
         bad = 1
         if (.not. regular) return
         bad = 0
         if (maxval(abs(step)) <= 1.0e-8_wp*maxval(abs(alpha - step(:, 1))) &
            & + 1.0e-14_wp*size_of) then
            alpha = alpha - step(:, 1)
            return
         end if
         call advance(element, input, motion, step(:, 1), alpha, force, pivot, bad)
      end do
      bad = 1
   end subroutine relax

   !> Go the Newton step, or as far of it as no point turns and the force along it does not reverse:
   !> points that unload are stiffer than the tangent says.
   pure subroutine advance(element, input, motion, step, alpha, force, pivot, turned)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: step(:)
      real(wp), intent(inout) :: alpha(:), force(:, :)
      real(wp), intent(out) :: pivot(:, :)
      integer, intent(out) :: turned
      real(wp) :: share, along, ahead
      integer, parameter :: most = 12
      integer :: try

      along = dot_product(force(:, 1), step)
      share = 1.0_wp
      do try = 1, most
         call balance(element, input, motion, alpha - share*step, force, pivot, turned)
         if (turned > 0) then
            share = 0.5_wp*share
            cycle
         end if
         ahead = dot_product(force(:, 1), step)
         if (along <= 0.0_wp .or. ahead >= -0.2_wp*along) exit
         if (try < most) share = share*max(0.1_wp, along/(along - ahead))
      end do
      alpha = alpha - share*step
   end subroutine advance

   !> Size of the strains that a point remembers.
   pure real(wp) function strained(memory, nstress)
      real(wp), intent(in) :: memory(:, :)
      integer, intent(in) :: nstress

      strained = 0.0_wp
      if (size(memory, 1) > 0) strained = max(maxval(abs(memory(:nstress, :))), &
         & maxval(abs(memory(offset_at(nstress), :))))
   end function strained

   !> Forces on the amplitudes and their slopes; `force` is kept where a point is `turned`.
   pure subroutine balance(element, input, motion, alpha, force, pivot, turned)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: alpha(:)
      real(wp), intent(inout) :: force(:, :)
      real(wp), intent(out) :: pivot(:, :)
      integer, intent(out) :: turned
      type(answer_type) :: answer
      real(wp) :: l(element%nmode, 9), sum_of(element%nmode)
      integer :: k

      pivot = 0.0_wp
      sum_of = 0.0_wp
      do k = 1, element%ngauss
         turned = k
         call respond(element, input, motion, k, alpha, answer)
         if (answer%bad) return
         call mode_rows(element, motion, k, answer, l)
         sum_of = sum_of + matmul(l, listed(element%ndim, answer%s))
         pivot = pivot + matmul(l, matmul(answer%a, transpose(l)))
      end do
      turned = 0
      force(:, 1) = sum_of
   end subroutine balance

   !> Deformation, stress and stiffness of a point.
   pure subroutine respond(element, input, motion, k, alpha, answer)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      type(answer_type), intent(out) :: answer
      real(wp) :: stress(element%nstress), tangent(element%nstress, element%nstress)
      real(wp) :: own, f(3, 3)
      type(point_type) :: point
      logical :: found
      integer :: i

      answer%h = motion%h(:, :, k) + summed(element, motion%e, k, alpha)
      own = volume_change(answer%h)
      answer%bad = .not. 1.0_wp + own > 0.0_wp
      if (element%ndim == 2) answer%bad = answer%bad .or. .not. 1.0_wp + answer%h(3, 3) > 0.0_wp
      if (answer%bad) return
      f = answer%h
      do i = 1, 3
         f(i, i) = f(i, i) + 1.0_wp
      end do
      answer%inverse(1, :) = cross(f(:, 2), f(:, 3))
      answer%inverse(2, :) = cross(f(:, 3), f(:, 1))
      answer%inverse(3, :) = cross(f(:, 1), f(:, 2))
      answer%inverse = answer%inverse/(1.0_wp + own)
      point%h = answer%h
      point%own = counted_volume(input, k, own)
      point%volume = point%own
      call trial_change(answer%h, input%memory(:, k), element%nstress, point%change)
      if (element%kind == element_kind%plane_stress) then
         call stretch_thickness(input%law, input%memory(:, k), element%nstress, input%dt, point, &
            & found)
         answer%bad = .not. found
         if (answer%bad) return
      end if
      call respond_at(input%law, point, input%memory(:, k), input%dt, stress, answer%energy, &
         & found, tangent)
      answer%bad = .not. found
      if (answer%bad) return
      if (element%kind == element_kind%plane_stress) call condense_thickness(tangent)
      answer%energy = motion%weight(k)*answer%energy
      answer%s = tensor_of(motion%weight(k)*stress)
      call velocity_form(element%ndim, stress, tangent, 0.0_wp, motion%weight(k), answer%a)
   end subroutine respond

   !> Gradient of the amplitudes, or F0 times it.
   pure function summed(element, modes, k, alpha) result(e)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: modes(:, :, :, :)   !! of motion_type or of modes_type
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      real(wp) :: e(3, 3)
      integer :: m

      e = 0.0_wp
      do m = 1, element%nmode
         e = e + alpha(m)*modes(:, :, m, k)
      end do
   end function summed

   !> Velocity gradients of the displacements of the nodes.
   pure subroutine node_rows(element, motion, k, alpha, answer, l)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      type(answer_type), intent(in) :: answer
      real(wp), intent(out) :: l(:, :)   !! (ndof, 9)
      real(wp) :: e(3, 3), slope(3)
      integer :: a, d, i, j

      d = element%ndim
      e = summed(element, motion%modes%e, k, alpha)
      l = 0.0_wp
      do a = 1, element%nnode
         slope(:d) = motion%g(:d, a, k) + matmul(motion%modes%g(:d, a), e(:d, :d))
         slope(:d) = matmul(slope(:d), answer%inverse(:d, :d))
         do j = 1, d
            do i = 1, d
               l(d*(a - 1) + i, i + d*(j - 1)) = slope(j)
            end do
         end do
         if (d == 2) l(2*a - 1, 5) = (motion%hoop(a, k) + e(3, 3)*motion%modes%hoop(a)) &
            & *answer%inverse(3, 3)
      end do
   end subroutine node_rows

   !> Velocity gradients of the amplitudes.
   pure subroutine mode_rows(element, motion, k, answer, l)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      type(answer_type), intent(in) :: answer
      real(wp), intent(out) :: l(:, :)   !! (nmode, 9)
      integer :: m

      do m = 1, element%nmode
         l(m, :) = listed(element%ndim, matmul(motion%e(:, :, m, k), answer%inverse))
      end do
   end subroutine mode_rows

   !> Stress times the gradient that an amplitude makes of a displacement of the centre.
   pure subroutine add_swap(element, motion, k, answer, block)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      type(answer_type), intent(in) :: answer
      real(wp), intent(inout) :: block(:, :)   !! (ndof, nmode)
      real(wp) :: p(3, 3), half(3, 3)
      integer :: a, d, m

      d = element%ndim
      p = matmul(answer%s, transpose(answer%inverse))
      do m = 1, element%nmode
         half = matmul(p, transpose(motion%modes%e(:, :, m, k)))
         do a = 1, element%nnode
            block(d*(a - 1) + 1:d*a, m) = block(d*(a - 1) + 1:d*a, m) &
               & + matmul(half(:d, :d), motion%modes%g(:d, a))
            if (d == 2) block(2*a - 1, m) = block(2*a - 1, m) &
               & + half(3, 3)*motion%modes%hoop(a)
         end do
      end do
   end subroutine add_swap
end module lopin_solid_enhanced
