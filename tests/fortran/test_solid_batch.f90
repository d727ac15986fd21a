!> Elements in space several at a time: the bits of one at a time.
program test_solid_batch
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_formulation, &
      & new_element_type
   use lopin_flow_curve, only : table_flow, voce_flow, flow_type
   use lopin_hyperelastic, only : solid_law_type, hencky_law, neo_hooke_law, green_law, give_flow
   use lopin_material_memory, only : memory_size, strain_at, amplitudes_of
   use lopin_element_batch, only : batch_type, kept_type, lanes, points, &
      & is_batchable, put_memory
   use lopin_solid_batch, only : evaluate_batch
   use lopin_batch_end, only : keep_batch
   use lopin_batch_kernel, only : compute_batch, compute_stresses, compute_kept
   use lopin_element_input, only : element_input_type
   use lopin_solid_finite_strain, only : finite_strain_stresses, finite_strain_memory
   use element_calls, only : element_at
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, dt = 0.1_wp
   character(len=*), parameter :: words(6) = ['C3D8 ', 'C3D8R', 'C3D4 ', 'C3D6 ', 'C3D8I', &
      & 'CSS8 ']
   character(len=*), parameter :: wishes(2) = ['    ', 'FULL']
   integer, parameter :: widths(3) = [2, 4, 8]   ! of vectors; of those the processor has
   type(element_type) :: element
   type(solid_law_type), target :: law
   type(flow_type) :: flow
   type(batch_type) :: batch
   type(kept_type) :: kept
   real(wp) :: x(3, 8, lanes), u(3, 8, lanes)
   real(wp), allocatable :: memory(:, :, :)
   integer :: i, j, k, seed
   logical :: found

   seed = 11
   do i = 1, size(words)
      do j = 1, size(wishes)
         if (words(i) == 'CSS8' .and. j > 1) cycle   ! one rule alone
         call new_element_type(element, trim(words(i)), trim(wishes(j)), found)
         do k = 1, 4
            law = hencky_law(young, 0.3_wp)
            flow = table_flow([0.0_wp, 0.5_wp], [0.3_wp, 0.6_wp])
            if (k == 3) flow = voce_flow(0.5_wp, 0.3_wp, 4.0_wp, 0.2_wp)
            if (k == 3) flow%rate = 10.0_wp
            if (k == 3) flow%power = 5.0_wp
            if (k > 1) call give_flow(law, flow)
            call is_true('can be computed in batches', is_batchable(element, law))
            call choose_motions()
            call same_bits()
            call same_ends()
         end do
      end do
   end do
   call leaves_what_turns()
   call takes_no_other()
   call finish()

contains

   !> Distorted elements: one at rest, one stretched along the axes, one turned in the plane, others
   !> deformed at will; k = 4: by rounding alone.
   subroutine choose_motions()
      real(wp) :: h(3, 3), noise, list(9), far
      integer :: a, lane, m

      far = merge(0.01_wp, 0.2_wp, element%nmode > 0)
      if (allocated(memory)) deallocate (memory)
      allocate (memory(merge(memory_size(6), 0, law%remembers), element%ngauss, lanes))
      do lane = 1, lanes
         do a = 1, element%nnode
            do m = 1, 3
               call random(seed, noise)
               x(m, a, lane) = element%cell%xi(m, a) + 0.15_wp*noise
            end do
         end do
         do m = 1, 9
            call random(seed, noise)
            list(m) = far*noise
         end do
         h = reshape(list, [3, 3])
         if (lane == 2) h = 0.0_wp
         if (lane == 3) h(:, 3) = 0.0_wp
         if (lane == 3) h(3, :) = 0.0_wp
         if (lane == 4) h = reshape([0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.1_wp, 0.0_wp, 0.0_wp, &
            & 0.0_wp, -0.2_wp], [3, 3])
         if (k == 4) h = 1.0e-9_wp*h
         u(:, :element%nnode, lane) = matmul(h, x(:, :element%nnode, lane))
         if (lane > 4) u(1, 2, lane) = u(1, 2, lane) + 0.25_wp*far
         do a = 1, element%ngauss
            do m = 1, size(memory, 1)
               call random(seed, memory(m, a, lane))
            end do
         end do
      end do
      memory = merge(0.0002_wp, 0.04_wp, element%nmode > 0)*memory
      if (.not. law%remembers) return
      memory(strain_at(6), :, :) = abs(memory(strain_at(6), :, :))
      memory(:, :, 2) = 0.0_wp
   end subroutine choose_motions

   subroutine fill()
      integer :: lane

      batch%dt = dt
      do lane = 1, lanes
         batch%x(lane, :, :) = x(:, :, lane)
         batch%u(lane, :, :) = u(:, :, lane)
         call put_memory(element, batch, lane, memory(:, :, lane))
      end do
   end subroutine fill

   subroutine same_bits()
      real(wp) :: force(element%ndof), energy, ke(element%ndof, element%ndof)
      real(wp) :: own(3, 8), block(3, 8, 3, 8), full(element%ndof, element%ndof)
      integer :: a, bad, lane, n, way
      logical :: done

      n = element%nnode
      do way = 1, 6
         call test('a batch has the bits of its elements: '//element%word//wishes(j) &
            & //merge(' tangent', ' force  ', way <= 3))
         call fill()
         call compute_batch(element, law, way <= 3, batch, done, widths(1 + mod(way, 3)))
         call is_true('none is turned', done)
         do lane = 1, lanes
            call element_at(.true., element, law, x(:, :n, lane), u(:, :n, lane), 1.0_wp, &
               & memory(:, :, lane), dt, force, energy, bad, ke)
            own = batch%force(lane, :, :)
            call is_true('force', all(abs(reshape(own(:, :n), [3*n]) - force) <= 0.0_wp))
            call is_true('energy', abs(batch%energy(lane) - energy) <= 0.0_wp)
            if (way > 3) cycle
            block = batch%ke(lane, :, :, :, :)
            full = reshape(block(:, :n, :, :n), [3*n, 3*n])
            do a = 1, 3*n
               call is_true('stiffness', all(abs(full(a:, a) - ke(a:, a)) <= 0.0_wp))
            end do
         end do
      end do
   end subroutine same_bits

   !> Stresses, strains and memory where an increment ends.
   subroutine same_ends()
      real(wp), dimension(lanes, 6, points) :: found, elongation
      real(wp), dimension(6, element%ngauss) :: stress, strain
      real(wp), dimension(3, element%nnode), target :: place, moved
      real(wp), allocatable, target :: past(:, :)
      real(wp), allocatable :: next(:, :)
      real(wp) :: work, held
      type(element_input_type) :: input
      integer :: bad, lane, way
      logical :: done

      do way = 1, size(widths)
         call test('a batch keeps the bits of its elements: '//element%word//wishes(j))
         call fill()
         call compute_stresses(element, law, batch, found, elongation, done, widths(way))
         call compute_kept(element, law, batch, kept, done, widths(way))
         call is_true('none is turned', done)
         do lane = 1, lanes
            place = x(:, :element%nnode, lane)
            moved = u(:, :element%nnode, lane)
            past = memory(:, :, lane)
            input = element_input_type(law, place, moved, past, 1.0_wp, dt, .false.)
            call finite_strain_stresses(element, input, stress, strain, bad)
            call is_true('stress', all(abs(found(lane, :, :element%ngauss) - stress) <= 0.0_wp))
            call is_true('strain', all(abs(elongation(lane, :, :element%ngauss) - strain) &
               & <= 0.0_wp))
            if (.not. law%remembers) cycle
            next = past
            call finite_strain_memory(element, input, next, work, held, bad)
            call is_true('volume', abs(kept%held(lane) - held) <= 0.0_wp)
            call is_true('amplitudes', all(abs(amplitudes_of(next, 6, element%nmode) &
               & - kept%amplitude(lane, :element%nmode)) <= 0.0_wp))
            call is_true('metric', all(abs(past(:6, :) + kept%metric(lane, :, :element%ngauss) &
               & - next(:6, :)) <= 0.0_wp))
            call is_true('strain', all(abs(past(strain_at(6), :) + kept%step(lane, &
               & :element%ngauss) - next(strain_at(6), :)) <= 0.0_wp))
         end do
      end do
   end subroutine same_ends

   subroutine leaves_what_turns()
      logical :: done
      integer :: lane

      call test('a batch with an element inside out is not done')
      call new_element_type(element, 'C3D8', '', found)
      law = hencky_law(young, 0.3_wp)
      do lane = 1, 2
         k = 1
         call choose_motions()
         if (lane == 1) u(:, :, 5) = -1.5_wp*x(:, :, 5)
         if (lane == 2) x(:, [1, 2], 6) = x(:, [2, 1], 6)
         call fill()
         call evaluate_batch(element, law, .true., batch, done)
         call is_true('not done', .not. done)
         call keep_batch(element, law, batch, kept, done)
         call is_true('nothing kept', .not. done)
      end do
   end subroutine leaves_what_turns

   !> Elements that the batch does not know are left alone, whatever words come.
   subroutine takes_no_other()
      character(len=*), parameter :: known(12) = [character(len=7) :: 'C3D4', 'C3D4H', 'C3D6', &
         & 'C3D6H', 'C3D6R', 'C3D8', 'C3D8R', 'C3D8H', 'C3D8RH', 'C3D8I', &
         & 'C3D8IH', 'CSS8']
      integer :: w

      call test('other elements and laws go one by one')
      law = hencky_law(young, 0.3_wp)
      do w = 1, size(element_words)
         call new_element_type(element, trim(element_words(w)), '', found)
         call is_true(element_words(w), is_batchable(element, law) &
            & .eqv. any(known == element_words(w)))
      end do
      call new_element_type(element, 'C3D8', '', found)
      call is_true('neo-Hooke', .not. is_batchable(element, neo_hooke_law(1.0_wp, 0.1_wp)))
      call is_true('Green', .not. is_batchable(element, green_law(young, 0.3_wp)))
      element%formulation = element_formulation%projected
      call is_true('projected', .not. is_batchable(element, law))
   end subroutine takes_no_other
end program test_solid_batch
