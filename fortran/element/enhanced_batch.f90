!> Enhanced bricks at finite strain, several of one type and material at a time: module
!> solid_enhanced, in the same operations, with the element as the fastest index. Compiled three
!> times, see module batch_kernel.
module lopin_enhanced_batch
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, most
   use lopin_enhanced_modes, only : solve_small, most_modes
   use lopin_hyperelastic, only : solid_law_type
   use lopin_batch_motion, only : motion_type, gradients, trial_change, volume_change
   use lopin_batch_stiffness, only : add_force, add_stiffness_in_lanes
   use lopin_enhanced_lane_motion, only : modes_lanes_type, move_lanes, enhanced_change, &
      & mode_gradient, mode_rows
   use lopin_enhanced_lanes, only : relaxed_lanes_type, relax_lanes, whole_pivot, products, &
      & tensor_of
   implicit none
   private
   public :: evaluate_enhanced, deform_enhanced

contains

   !> Forces, energies and, if asked for, tangents.
   pure subroutine evaluate_enhanced(element, law, with_tangent, batch, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: with_tangent
      type(batch_type), intent(inout) :: batch
      logical, intent(out) :: done               !! no element asks for more than full steps
      type(modes_lanes_type), allocatable :: motion      ! too large for a stack
      type(relaxed_lanes_type), allocatable :: relaxed   ! the same
      real(wp) :: with_nodes(lanes, element%nmode, 3, element%nnode)
      real(wp) :: swap(lanes, 3, 3, element%nmode), g(lanes, 3, most)
      integer :: k, l, m

      allocate (motion, relaxed)
      call move_lanes(element, batch, motion, done)
      if (.not. done) return
      call relax_lanes(element, law, batch, motion, relaxed, done)
      if (.not. done) return
      batch%force = 0.0_wp
      if (with_tangent) batch%ke = 0.0_wp
      with_nodes = 0.0_wp
      swap = 0.0_wp
      batch%energy = 0.0_wp
      do k = 1, element%ngauss
         associate (answer => relaxed%answer(k))
            batch%energy = batch%energy + answer%energy
            call node_slopes(element, motion, k, relaxed%alpha, answer%inverse, g)
            call add_force(element%nnode, g, answer%stress, motion%weight(:, k), batch%force)
            call add_coupling(element, motion, k, answer%inverse, answer%a, g, with_nodes)
            call add_swap(element, motion, k, answer%inverse, answer%stress, swap)
            if (with_tangent) call add_stiffness_in_lanes(element%nnode, g, answer%a, batch%ke)
         end associate
      end do
      call couple_centre(element, motion, swap, with_nodes)
      m = element%nmode
      do l = 1, lanes
         batch%energy(l) = batch%energy(l) - 0.5_wp*dot_product(relaxed%force(l, :m), &
            & relaxed%rest(l, :m))
         call follow_nodes(element, l, with_tangent, relaxed, with_nodes(l, :, :, :), batch)
      end do
   end subroutine evaluate_enhanced

   !> Slopes, in the deformed place, of what the displacement of a node does at a point.
   pure subroutine node_slopes(element, motion, k, alpha, inverse, g)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(lanes, most_modes), inverse(lanes, 3, 3)
      real(wp), intent(out) :: g(lanes, 3, element%nnode)    !! [1/length]
      real(wp) :: e(lanes, 3, 3), slope(lanes, 3)
      integer :: a, i, j

      call mode_gradient(element, motion, k, alpha, e)
      do a = 1, element%nnode
         do i = 1, 3
            slope(:, i) = motion%g(:, i, a, k)
            do j = 1, 3
               slope(:, i) = slope(:, i) + motion%at_centre(:, j, a)*e(:, j, i)
            end do
         end do
         do j = 1, 3
            g(:, j, a) = slope(:, 1)*inverse(:, 1, j) + slope(:, 2)*inverse(:, 2, j) &
               & + slope(:, 3)*inverse(:, 3, j)
         end do
      end do
   end subroutine node_slopes

   !> Stiffness between the amplitudes and the nodes.
   pure subroutine add_coupling(element, motion, k, inverse, a, g, with_nodes)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: inverse(lanes, 3, 3), a(lanes, 9, 9), g(lanes, 3, element%nnode)
      real(wp), intent(inout) :: with_nodes(lanes, element%nmode, 3, element%nnode)
      real(wp), dimension(lanes, 9, element%nmode) :: l, al
      real(wp) :: c(lanes)
      integer :: i, j, m, node

      call mode_rows(element, motion, k, inverse, l)
      call products(element, a, l, al)
      do node = 1, element%nnode
         do i = 1, 3
            do m = 1, element%nmode
               c = with_nodes(:, m, i, node)
               do j = 1, 3
                  c = c + al(:, i + 3*(j - 1), m)*g(:, j, node)
               end do
               with_nodes(:, m, i, node) = c
            end do
         end do
      end do
   end subroutine add_coupling

   !> Stress times the gradient that an amplitude makes of a displacement of the centre.
   pure subroutine add_swap(element, motion, k, inverse, stress, swap)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: inverse(lanes, 3, 3), stress(lanes, 6)
      real(wp), intent(inout) :: swap(lanes, 3, 3, element%nmode)
      real(wp), dimension(lanes, 3, 3) :: p, s
      integer :: i, j, m

      s = tensor_of(motion%weight(:, k), stress)
      do j = 1, 3
         do i = 1, 3
            p(:, i, j) = s(:, i, 1)*inverse(:, j, 1) + s(:, i, 2)*inverse(:, j, 2) &
               & + s(:, i, 3)*inverse(:, j, 3)
         end do
      end do
      do m = 1, element%nmode
         do j = 1, 3
            do i = 1, 3
               swap(:, i, j, m) = swap(:, i, j, m) + (p(:, i, 1)*motion%mode(:, j, 1, m, k) &
                  & + p(:, i, 2)*motion%mode(:, j, 2, m, k) &
                  & + p(:, i, 3)*motion%mode(:, j, 3, m, k))
            end do
         end do
      end do
   end subroutine add_swap

   !> What `add_swap` has summed, between modes and nodes.
   pure subroutine couple_centre(element, motion, swap, with_nodes)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      real(wp), intent(in) :: swap(lanes, 3, 3, element%nmode)
      real(wp), intent(inout) :: with_nodes(lanes, element%nmode, 3, element%nnode)
      integer :: a, i, j, m

      do a = 1, element%nnode
         do j = 1, 3
            do i = 1, 3
               do m = 1, element%nmode
                  with_nodes(:, m, i, a) = with_nodes(:, m, i, a) &
                     & + swap(:, i, j, m)*motion%at_centre(:, j, a)
               end do
            end do
         end do
      end do
   end subroutine couple_centre

   !> The amplitudes of a lane follow its nodes: the last step in its forces, and its stiffness.
   pure subroutine follow_nodes(element, l, with_tangent, relaxed, with_nodes, batch)
      type(element_type), intent(in) :: element
      integer, intent(in) :: l                   !! the lane
      logical, intent(in) :: with_tangent
      type(relaxed_lanes_type), intent(in) :: relaxed
      real(wp), intent(in) :: with_nodes(element%nmode, 3*element%nnode)
      type(batch_type), intent(inout) :: batch
      real(wp), dimension(element%nmode, 3*element%nnode) :: follow
      real(wp) :: pivot(element%nmode, element%nmode), ke(3, most, 3, most)
      logical :: regular
      integer :: a, i, m, n

      m = element%nmode
      n = 3*element%nnode
      do i = 1, n
         a = 1 + (i - 1)/3
         batch%force(l, i - 3*(a - 1), a) = batch%force(l, i - 3*(a - 1), a) &
            & - dot_product(with_nodes(:, i), relaxed%rest(l, :m))
      end do
      if (.not. with_tangent) return
      pivot = whole_pivot(element, relaxed, l)
      follow = with_nodes
      call solve_small(pivot, follow, regular)
      ke = batch%ke(l, :, :, :, :)
      call condense(m, n, with_nodes, follow, ke)
      batch%ke(l, :, :, :, :) = ke
   end subroutine follow_nodes

   !> Take off what the amplitudes give way, below the diagonal.
   pure subroutine condense(m, n, with_nodes, follow, ke)
      integer, intent(in) :: m, n
      real(wp), intent(in) :: with_nodes(m, n), follow(m, n)
      real(wp), intent(inout) :: ke(3*most, 3*most)
      integer :: i, j

      do j = 1, n
         do i = j, n
            ke(i, j) = ke(i, j) - dot_product(with_nodes(:, i), follow(:, j))
         end do
      end do
   end subroutine condense

   !> Deformation of all points with the amplitudes in balance.
   pure subroutine deform_enhanced(element, law, batch, motion, amplitude, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(motion_type), intent(inout) :: motion   !! of its slopes nothing is set
      real(wp), intent(out) :: amplitude(lanes, most_modes)   !! [-]
      logical, intent(out) :: done
      type(modes_lanes_type), allocatable :: modes       ! too large for a stack
      type(relaxed_lanes_type), allocatable :: relaxed   ! the same
      real(wp) :: g(lanes, 3, most)
      integer :: k, m

      amplitude = 0.0_wp
      allocate (modes, relaxed)
      call move_lanes(element, batch, modes, done)
      if (.not. done) return
      call relax_lanes(element, law, batch, modes, relaxed, done)
      if (.not. done) return
      m = element%nmode
      amplitude(:, :m) = relaxed%alpha(:, :m) - relaxed%rest(:, :m)
      motion%averaged = .false.
      do k = 1, element%ngauss
         call gradients(element%nnode, batch%x, element%dn(:, :, k), g, motion%weight(:, k))
         motion%weight(:, k) = element%weight(k)*motion%weight(:, k)
         call enhanced_change(element, modes, k, amplitude, motion%h(:, :, :, k))
         call trial_change(motion%h(:, :, :, k), batch%metric(:, :, k), motion%change(:, :, :, k))
         call volume_change(motion%h(:, :, :, k), motion%own(:, k))
         done = all(1.0_wp + motion%own(:, k) > 0.0_wp)
         if (.not. done) return
         motion%volume(:, k) = motion%own(:, k)
      end do
   end subroutine deform_enhanced
end module lopin_enhanced_batch
