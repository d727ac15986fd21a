!> Elements whose material flows, small and finite strain: tangent, memory, internal modes.
program test_solid_flow
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_kind, &
      & element_formulation, new_element_type
   use lopin_flow_curve, only : flow_type, voce_flow
   use lopin_hyperelastic, only : solid_law_type, hencky_law, give_flow
   use lopin_material_memory, only : memory_size, strain_at
   use element_calls, only : element_at, remember_at
   use distinct_elements, only : stands_for_another
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, yield = 0.3_wp, thickness = 0.7_wp
   type(element_type) :: element
   type(solid_law_type) :: law
   type(flow_type) :: flow
   real(wp), allocatable :: memory(:, :)
   logical :: found, finite
   integer :: i, j, k

   do i = 1, size(element_words)
      if (stands_for_another(trim(element_words(i)), '')) cycle
      call new_element_type(element, trim(element_words(i)), '', found)
      if (element%kind == element_kind%rigid .or. element%kind == element_kind%plane_stress) cycle
      if (element%projectable) element%formulation = element_formulation%projected
      do j = 1, 2
         finite = j == 2
         do k = 1, 2
            flow = voce_flow(0.5_wp, yield, 4.0_wp, 0.2_wp)
            if (k == 2) flow%rate = 10.0_wp
            if (k == 2) flow%power = 5.0_wp
            law = hencky_law(young, 0.3_wp)
            call give_flow(law, flow)
            call commit_something()
            call tangent_is_the_slope_of_the_force()
            if (k == 1) call what_is_accepted_stays()
         end do
      end do
   end do
   call finish()

contains

   function name_of() result(name)
      character(len=:), allocatable :: name
      name = trim(element%word)//merge(', finite strain', ', small strain ', finite)
   end function name_of

   !> A distorted element with straight edges, off the axis.
   function distorted() result(x)
      real(wp) :: x(element%ndim, element%nnode), move
      integer :: a, m, seed

      seed = 7
      x = element%cell%xi(:element%ndim, :element%nnode)
      do a = 1, element%cell%ncorner
         do m = 1, element%ndim
            call random(seed, move)
            x(m, a) = x(m, a) + 0.15_wp*move
         end do
      end do
      do a = element%cell%ncorner + 1, element%nnode
         m = a - element%cell%ncorner
         x(:, a) = 0.5_wp*(x(:, element%cell%edge(1, m)) + x(:, element%cell%edge(2, m)))
      end do
      if (element%axisymmetric) x(1, :) = x(1, :) + 3.0_wp
   end function distorted

   !> Every point flows: strains of 0.2, the yield strain is 0.0014.
   function strained() result(u)
      real(wp) :: u(element%ndim, element%nnode), x(element%ndim, element%nnode), h(3, 3), noise
      integer :: a, m, seed

      seed = 23
      h = reshape([0.2_wp, 0.1_wp, -0.1_wp, -0.1_wp, -0.15_wp, 0.1_wp, 0.1_wp, 0.1_wp, 0.05_wp], &
         & [3, 3])
      x = distorted()
      u = matmul(h(:element%ndim, :element%ndim), x)
      do a = 1, element%nnode
         do m = 1, element%ndim
            call random(seed, noise)
            u(m, a) = u(m, a) + 0.01_wp*noise
         end do
      end do
   end function strained

   !> Plastic strains of some hundredths, different at every point, and amplitudes of the modes.
   subroutine commit_something()
      integer :: g, m, seed

      if (allocated(memory)) deallocate (memory)
      allocate (memory(memory_size(element%nstress), element%ngauss))
      seed = 41
      do g = 1, element%ngauss
         do m = 1, size(memory, 1)
            call random(seed, memory(m, g))
         end do
      end do
      memory = 0.04_wp*memory
      memory(strain_at(element%nstress), :) = abs(memory(strain_at(element%nstress), :))
   end subroutine commit_something

   subroutine force_at(u, force, ke)
      real(wp), intent(in) :: u(:, :)
      real(wp), intent(out) :: force(element%ndof)
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)
      real(wp) :: energy
      integer :: bad

      call element_at(finite, element, law, distorted(), u, thickness, memory, 0.1_wp, force, &
         & energy, bad, ke)
      call is_true('in balance', bad == 0)
   end subroutine force_at

   !> Against central differences of fourth order.
   subroutine tangent_is_the_slope_of_the_force()
      integer, parameter :: nway = 4           ! none of them leaves out an entry of the matrix
      real(wp), dimension(element%ndim, element%nnode) :: u, way
      real(wp) :: ke(element%ndof, element%ndof), force(element%ndof), f(element%ndof, 4)
      real(wp), dimension(element%ndof, nway) :: slope, found_
      real(wp), parameter :: step = 1.0e-4_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: a, m, s, w, seed

      call test('under flow the tangent is the slope of the force: '//name_of())
      u = strained()
      call force_at(u, force, ke)
      seed = 41
      do w = 1, nway
         do a = 1, element%nnode
            do m = 1, element%ndim
               call random(seed, way(m, a))
            end do
         end do
         do s = 1, 4
            call force_at(u + step*place(s)*way, f(:, s))
         end do
         slope(:, w) = (f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) - f(:, 4))/(12.0_wp*step)
         found_(:, w) = matmul(ke, reshape(way, [element%ndof]))
      end do
      call close_to('ke', found_/maxval(abs(ke)), slope/maxval(abs(ke)), 1.0e-8_wp)
      call close_to('symmetry', maxval(abs(ke - transpose(ke))), 0.0_wp, 0.0_wp)
   end subroutine tangent_is_the_slope_of_the_force

   !> Once accepted, the state needs the same forces and nothing flows further.
   subroutine what_is_accepted_stays()
      real(wp) :: u(element%ndim, element%nnode), before(element%ndof), after(element%ndof)
      real(wp) :: work, held
      integer :: bad

      call test('what is accepted stays: '//name_of())
      u = strained()
      call force_at(u, before)
      call remember(u, work, held, bad)
      call is_true('in balance', bad == 0)
      call is_true('work was done', work > 0.0_wp)
      call force_at(u, after)
      call close_to('force', after/maxval(abs(before)), before/maxval(abs(before)), 1.0e-10_wp)
      call remember(u, work, held, bad)
      call close_to('work', work/(held*yield), 0.0_wp, 1.0e-10_wp)
   end subroutine what_is_accepted_stays

   subroutine remember(u, work, held, bad)
      real(wp), intent(in) :: u(:, :)
      real(wp), intent(out) :: work, held
      integer, intent(out) :: bad

      call remember_at(finite, element, law, distorted(), u, thickness, 0.1_wp, memory, work, &
         & held, bad)
   end subroutine remember
end program test_solid_flow
