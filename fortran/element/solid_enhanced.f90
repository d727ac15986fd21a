!> Enhanced linear quads and bricks at finite strain: they bend without shear or thickness locking.
!>
!> The amplitudes alpha of the internal modes (module enhanced_motion) make the energy stationary at
!> given displacements: a local Newton iteration finds them at every call, from zero in an elastic
!> solid, from those of the accepted state where it flows. So the force is the slope of an energy of
!> the displacements alone, and the tangent is the exact one, symmetric. Points are not evaluated
!> after the last step, which is small: force and energy follow it by the stiffness at hand.
module lopin_solid_enhanced
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type, counted_volume
   use lopin_enhanced_modes, only : solve_small, most_modes, most_points
   use lopin_enhanced_motion, only : motion_type, move, mode_lanes, list_length, &
      & enhanced_change, node_slopes, mode_rows
   use lopin_velocity_form, only : velocity_form, add_force, add_stiffness, listed, tensor_of
   use lopin_hyperelastic, only : condense_thickness, volume_change
   use lopin_material_memory, only : trial_change, amplitudes_of, offset_at
   use lopin_material_point, only : point_type, respond_at, stretch_thickness
   implicit none
   private
   public :: enhanced_element, enhanced_deformation

   !> Answer of the material at a point.
   type :: answer_type
      real(wp) :: h(3, 3)                   !! enhanced F - 1
      real(wp) :: inverse(3, 3)             !! of the enhanced F
      real(wp) :: stress(6)                 !! Kirchhoff
      real(wp) :: a(9, 9)                   !! quadratic form on velocity gradients, times volume
      real(wp) :: energy
      logical :: bad                        !! turned inside out
   end type answer_type

   !> Amplitudes on their way to where the energy is stationary.
   type :: relaxed_type
      real(wp) :: alpha(most_modes)
      type(answer_type) :: answer(most_points)   !! at alpha
      real(wp) :: force(most_modes)              !! on the amplitudes there
      real(wp) :: pivot(most_modes, most_modes)  !! its slopes
      real(wp) :: rest(most_modes)               !! the last, small step: alpha - rest balances
   end type relaxed_type

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
      type(relaxed_type) :: relaxed
      real(wp) :: own(mode_lanes(element), element%nmode)
      real(wp) :: with_nodes(mode_lanes(element), element%ndof), l(mode_lanes(element), 9)
      real(wp) :: swap(3, 3, element%nmode)
      real(wp) :: g(element%ndim, element%nnode), hoop(element%nnode)
      integer :: k, m

      call move(element, input, motion, bad)
      if (bad > 0) return
      call relax(element, input, motion, relaxed, bad)
      if (bad > 0) return
      m = element%nmode
      energy = sum(relaxed%answer(:element%ngauss)%energy) &
         & - 0.5_wp*dot_product(relaxed%force(:m), relaxed%rest(:m))
      force = 0.0_wp
      if (present(ke)) ke = 0.0_wp
      own = 0.0_wp
      with_nodes = 0.0_wp
      swap = 0.0_wp
      do k = 1, element%ngauss
         associate (answer => relaxed%answer(k))
            call node_slopes(element, motion, k, relaxed%alpha(:m), answer%inverse, g, hoop)
            call add_force(element%ndim, element%nnode, g, hoop, &
               & answer%stress(:element%nstress), motion%weight(k), force)
            call mode_rows(element, motion, k, answer%inverse, l)
            call add_modes(element, answer%a, l, own, g, hoop, with_nodes)
            call add_swap(element, motion, k, answer, swap)
            if (present(ke)) call add_stiffness(element%ndim, element%nnode, g, hoop, answer%a, ke)
         end associate
      end do
      call couple_centre(element, motion, swap, with_nodes)
      do k = 1, element%ndof
         force(k) = force(k) - dot_product(with_nodes(:m, k), relaxed%rest(:m))
      end do
      if (present(ke)) call condense(whole(element, own), with_nodes(:m, :), ke)
   end subroutine enhanced_element

   !> Stiffness of the amplitudes, its part below the diagonal, and between them and the nodes.
   !>
   !> Four amplitudes at a time, so that their sums stay in registers.
   pure subroutine add_modes(element, a, l, own, g, hoop, with_nodes)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: a(9, 9)                       !! quadratic form
      real(wp), intent(in) :: l(mode_lanes(element), 9)     !! velocity gradients of the modes
      real(wp), intent(inout) :: own(mode_lanes(element), element%nmode)
      real(wp), intent(in), optional :: g(element%ndim, element%nnode), hoop(element%nnode)
      real(wp), intent(inout), optional :: with_nodes(mode_lanes(element), element%ndof)
      real(wp) :: al(mode_lanes(element), 9), c(4)
      integer :: d, i, j, m, n, node, p

      d = element%ndim
      n = list_length(element)
      do p = 0, mode_lanes(element) - 4, 4
         do j = 1, n
            c = 0.0_wp
            do i = 1, n
               c = c + l(p + 1:p + 4, i)*a(i, j)
            end do
            al(p + 1:p + 4, j) = c
         end do
         do m = 1, min(p + 4, element%nmode)
            c = own(p + 1:p + 4, m)
            do j = 1, n
               c = c + al(p + 1:p + 4, j)*l(m, j)
            end do
            own(p + 1:p + 4, m) = c
         end do
         if (.not. present(with_nodes)) cycle
         do node = 1, element%nnode
            do i = 1, d
               m = d*(node - 1) + i
               c = with_nodes(p + 1:p + 4, m)
               do j = 1, d
                  c = c + al(p + 1:p + 4, i + d*(j - 1))*g(j, node)
               end do
               if (d == 2 .and. i == 1) c = c + al(p + 1:p + 4, 5)*hoop(node)
               with_nodes(p + 1:p + 4, m) = c
            end do
         end do
      end do
   end subroutine add_modes

   !> Stress times the gradient that an amplitude makes of a displacement of the centre.
   pure subroutine add_swap(element, motion, k, answer, swap)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      type(answer_type), intent(in) :: answer
      real(wp), intent(inout) :: swap(3, 3, element%nmode)
      real(wp) :: p(3, 3), stress(3, 3)
      integer :: j, m

      stress = tensor_of(motion%weight(k)*answer%stress(:element%nstress))
      do j = 1, 3
         p(:, j) = stress(:, 1)*answer%inverse(j, 1) + stress(:, 2)*answer%inverse(j, 2) &
            & + stress(:, 3)*answer%inverse(j, 3)
      end do
      do m = 1, element%nmode
         do j = 1, 3
            swap(:, j, m) = swap(:, j, m) + (p(:, 1)*motion%modes%e(j, 1, m, k) &
               & + p(:, 2)*motion%modes%e(j, 2, m, k) + p(:, 3)*motion%modes%e(j, 3, m, k))
         end do
      end do
   end subroutine add_swap

   !> What `add_swap` has summed, between modes and nodes.
   pure subroutine couple_centre(element, motion, swap, with_nodes)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: swap(3, 3, element%nmode)
      real(wp), intent(inout) :: with_nodes(mode_lanes(element), element%ndof)
      integer :: a, d, i, j, m

      d = element%ndim
      m = element%nmode
      do a = 1, element%nnode
         do j = 1, d
            do i = 1, d
               with_nodes(:m, d*(a - 1) + i) = with_nodes(:m, d*(a - 1) + i) &
                  & + swap(i, j, :)*motion%modes%g(j, a)
            end do
         end do
         if (d == 2) with_nodes(:m, 2*a - 1) = with_nodes(:m, 2*a - 1) &
            & + swap(3, 3, :)*motion%modes%hoop(a)
      end do
   end subroutine couple_centre

   !> The stiffness of the amplitudes from its part below the diagonal.
   pure function whole(element, lower) result(own)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: lower(mode_lanes(element), element%nmode)
      real(wp) :: own(element%nmode, element%nmode)
      integer :: m

      do m = 1, element%nmode
         own(m:, m) = lower(m:element%nmode, m)
         own(m, m:) = lower(m:element%nmode, m)
      end do
   end function whole

   !> The amplitudes follow the nodes.
   pure subroutine condense(own, with_nodes, ke)
      real(wp), contiguous, intent(in) :: own(:, :), with_nodes(:, :)
      real(wp), contiguous, intent(inout) :: ke(:, :)        !! blocks below the diagonal are set
      real(wp) :: pivot(size(own, 1), size(own, 2))
      real(wp) :: follow(size(with_nodes, 1), size(with_nodes, 2))
      logical :: regular
      integer :: i, j, n

      n = size(ke, 1)
      pivot = own
      follow = with_nodes
      call solve_small(pivot, follow, regular)
      do j = 1, n
         do i = j, n
            ke(i, j) = ke(i, j) - dot_product(with_nodes(:, i), follow(:, j))
            ke(j, i) = ke(i, j)
         end do
      end do
   end subroutine condense

   !> Enhanced F - 1 at the Gauss points.
   pure subroutine enhanced_deformation(element, input, h, alpha, bad)
      type(element_type), intent(in) :: element    !! with nmode > 0
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: h(3, 3, element%ngauss)
      real(wp), intent(out) :: alpha(element%nmode)   !! amplitudes [-]
      integer, intent(out) :: bad                  !! Gauss point turned inside out, else 0
      type(motion_type) :: motion
      type(relaxed_type) :: relaxed
      integer :: k

      h = 0.0_wp
      alpha = 0.0_wp
      call move(element, input, motion, bad)
      if (bad > 0) return
      call relax(element, input, motion, relaxed, bad)
      if (bad > 0) return
      alpha = relaxed%alpha(:element%nmode) - relaxed%rest(:element%nmode)
      do k = 1, element%ngauss
         h(:, :, k) = enhanced_change(element, motion, k, alpha)
      end do
   end subroutine enhanced_deformation

   !> Amplitudes that make the energy stationary, but for a last step.
   pure subroutine relax(element, input, motion, relaxed, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      type(relaxed_type), intent(out) :: relaxed
      integer, intent(out) :: bad
      real(wp) :: step(element%nmode, 1), pivot(element%nmode, element%nmode), size_of
      integer, parameter :: most = 60
      real(wp), parameter :: small = 1.0e-6_wp   ! its square is left out
      integer :: m, sweep
      logical :: regular

      m = element%nmode
      relaxed%alpha(:m) = amplitudes_of(input%memory, element%nstress, m)
      size_of = max(maxval(abs(motion%h(:, :, :element%ngauss))), &
         & strained(input%memory, element%nstress))
      call balance(element, input, motion, relaxed, bad)
      if (bad > 0 .and. any(abs(relaxed%alpha(:m)) > 0.0_wp)) then
         relaxed%alpha(:m) = 0.0_wp
         call balance(element, input, motion, relaxed, bad)
      end if
      do sweep = 1, most
         if (bad > 0) return
         pivot = relaxed%pivot(:m, :m)
         step(:, 1) = relaxed%force(:m)
         call solve_small(pivot, step, regular)
         bad = 1
         if (.not. regular) return
         bad = 0
         if (maxval(abs(step)) <= small*maxval(abs(relaxed%alpha(:m) - step(:, 1))) &
            & + 1.0e-14_wp*size_of) then
            relaxed%rest(:m) = step(:, 1)
            return
         end if
         call advance(element, input, motion, step(:, 1), relaxed, bad)
      end do
      bad = 1
   end subroutine relax

   !> Go the Newton step, or as far of it as no point turns and the force along it does not reverse:
   !> points that unload are stiffer than the tangent says.
   pure subroutine advance(element, input, motion, step, relaxed, turned)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: step(element%nmode)
      type(relaxed_type), intent(inout) :: relaxed
      integer, intent(out) :: turned
      real(wp) :: begun(element%nmode), share, along, ahead
      integer, parameter :: most = 12
      integer :: m, try

      m = element%nmode
      begun = relaxed%alpha(:m)
      along = dot_product(relaxed%force(:m), step)
      share = 1.0_wp
      do try = 1, most
         relaxed%alpha(:m) = begun - share*step
         call balance(element, input, motion, relaxed, turned)
         if (turned > 0) then
            share = 0.5_wp*share
            cycle
         end if
         ahead = dot_product(relaxed%force(:m), step)
         if (along <= 0.0_wp .or. ahead >= -0.2_wp*along) exit
         share = share*max(0.1_wp, along/(along - ahead))
      end do
   end subroutine advance

   !> Size of the strains that a point remembers.
   pure real(wp) function strained(memory, nstress)
      real(wp), intent(in) :: memory(:, :)
      integer, intent(in) :: nstress

      strained = 0.0_wp
      if (size(memory, 1) > 0) strained = max(maxval(abs(memory(:nstress, :))), &
         & maxval(abs(memory(offset_at(nstress), :))))
   end function strained

   !> Answers of the points, forces on the amplitudes and their slopes; the forces are kept where a
   !> point is `turned`.
   pure subroutine balance(element, input, motion, relaxed, turned)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(in) :: motion
      type(relaxed_type), intent(inout) :: relaxed
      integer, intent(out) :: turned
      real(wp) :: own(mode_lanes(element), element%nmode)
      real(wp) :: l(mode_lanes(element), 9), sum_of(mode_lanes(element)), s(9)
      integer :: j, k, m

      m = element%nmode
      own = 0.0_wp
      sum_of = 0.0_wp
      do k = 1, element%ngauss
         turned = k
         associate (answer => relaxed%answer(k))
            call respond(element, input, motion, k, relaxed%alpha(:m), answer)
            if (answer%bad) return
            call mode_rows(element, motion, k, answer%inverse, l)
            s = listed(element%ndim, tensor_of(motion%weight(k)*answer%stress(:element%nstress)))
            call add_modes(element, answer%a, l, own)
         end associate
         do j = 1, list_length(element)
            sum_of = sum_of + l(:, j)*s(j)
         end do
      end do
      turned = 0
      relaxed%pivot(:m, :m) = whole(element, own)
      relaxed%force(:m) = sum_of(:m)
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

      answer%h = enhanced_change(element, motion, k, alpha)
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
      answer%stress(:element%nstress) = stress
      call velocity_form(element%ndim, stress, tangent, 0.0_wp, motion%weight(k), answer%a)
   end subroutine respond
end module lopin_solid_enhanced
