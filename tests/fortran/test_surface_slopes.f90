!> What laws of friction read of the solids, von Mises' stress and that of flow, has the slopes of
!> its own differences: every element, laws with and without a memory, both kinematics.
program test_surface_slopes
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_flow_curve, only : table_flow, swift_flow, give_viscosity
   use lopin_yield_hill, only : hill_yield
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_solid_configuration, only : configuration_type
   use lopin_state, only : solids_state_type
   use lopin_solid_memory, only : new_solid_memory
   use lopin_surface_stress, only : surface_stress_type, new_surface_stress, find_stress
   use lopin_surface_slopes, only : slopes_type, find_slopes
   use distinct_elements, only : stands_for_another
   use blocks, only : new_block, random
   use check, only : test, close_to, is_true, finish
   implicit none
   character(len=4), parameter :: wishes(2) = [character(len=4) :: '', 'FULL']
   character(len=9), parameter :: laws(7) = [character(len=9) :: 'elastic', 'rubber', 'table', &
      & 'viscous', 'rigid', 'Hill', 'moving']
   type(mesh_type), target :: mesh
   type(element_type) :: element
   type(solids_type), target :: solids
   type(solids_state_type), target :: memory
   integer :: i, j, l
   logical :: found

   do i = 1, size(element_words)
      do j = 1, size(wishes)
         if (stands_for_another(trim(element_words(i)), wishes(j))) cycle
         call new_element_type(element, trim(element_words(i)), wishes(j), found)
         if (element%kind == element_kind%rigid) cycle
         do l = 1, size(laws)
            if (laws(l) == 'rigid' .and. element%kind == element_kind%plane_stress) cycle
            ! FULL is of the integration, not of the law.
            if (wishes(j) == 'FULL' .and. mod(l, 2) == 0) cycle
            ! Hill's metal and that which moves read the same: an element has either by one kinematics.
            if (takes_part(.true.)) call slopes_are_those_of_differences(.true.)
            if (takes_part(.false.)) call slopes_are_those_of_differences(.false.)
         end do
      end do
   end do
   call finish()

contains

   logical function takes_part(finite)
      logical, intent(in) :: finite

      takes_part = finite .or. laws(l) /= 'rubber'
      if (laws(l) == 'Hill') takes_part = finite .eqv. mod(i, 2) == 1
      if (laws(l) == 'moving' .and. wishes(j) /= 'FULL') takes_part = finite .eqv. mod(i, 2) == 0
   end function takes_part

   !> The law of the name on a block of two boxes each way.
   subroutine make(finite)
      logical, intent(in) :: finite
      type(solid_section_type) :: section
      type(csc_type) :: matrix
      type(error_type), allocatable :: error
      integer, allocatable :: dof(:, :)
      integer :: n, k

      call new_block(mesh, element%cell, [2, 2, 2], [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 2.0_wp, &
         & 1.0_wp], 0.2_wp)
      allocate (dof(6, mesh%nnode), source=0)
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = mesh%ndim*(n - 1) + [(k, k=1, mesh%ndim)]
      end do
      section = solid_section_type(wishes(j), 210.0_wp, 0.3_wp, 0.5_wp)
      select case (laws(l))
      case ('rubber')
         section = solid_section_type(wishes(j), 0.0_wp, 0.0_wp, 0.5_wp, .true., 40.0_wp, &
            & 0.01_wp)
      case ('table', 'Hill')
         section%flow = table_flow([0.0_wp, 2.0_wp], [1.0_wp, 3.0_wp])
      case ('viscous', 'rigid')
         call give_viscosity(section%flow, 0.8_wp, 0.3_wp)
         section%flow%rigid = laws(l) == 'rigid'
      case ('moving')
         section%flow = swift_flow(2.0_wp, 0.01_wp, 0.2_wp)
      end select
      if (laws(l) == 'Hill' .or. laws(l) == 'moving') then
         allocate (section%plastic)
         section%plastic%yield = hill_yield([1.0_wp, 1.3_wp, 0.8_wp, 0.9_wp, 1.2_wp, 0.7_wp])
         if (laws(l) == 'moving') then
            section%plastic%kinematic%n = 1
            section%plastic%kinematic%modulus(1) = 0.7_wp
         end if
      end if
      call new_solids(solids, mesh, [trim(element_words(i))], [section], dof, matrix, error)
      call is_true('no error', .not. allocated(error))
      call new_solid_memory(memory, solids, mesh)
      memory%finite_strain = finite
   end subroutine make

   subroutine slopes_are_those_of_differences(finite)
      logical, intent(in) :: finite
      type(surface_stress_type), target :: surface
      type(slopes_type), allocatable :: slopes(:)
      real(wp), allocatable, target :: u(:), way(:)
      real(wp), parameter :: step = 2.0e-5_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      real(wp), allocatable :: mises(:, :), flow(:, :), found_(:, :), rate(:, :)
      integer, allocatable :: node(:)
      integer :: k, n, seed
      real(wp) :: noise
      logical :: exact

      call test('slopes of the stress at the skin: '//trim(element_words(i))//' '//wishes(j)// &
         & ' '//trim(laws(l))//merge(' finite', ' small ', finite))
      call make(finite)
      node = [1, 2, mesh%nnode]
      call new_surface_stress(surface, solids, mesh, node, l > 2, .true.)
      seed = 5
      allocate (u(mesh%ndim*mesh%nnode), way(mesh%ndim*mesh%nnode))
      do k = 1, size(u)
         associate (x => mesh%x(:, 1 + (k - 1)/mesh%ndim), c => 1 + mod(k - 1, mesh%ndim))
            call random(seed, noise)
            u(k) = (0.1_wp + 0.03_wp*real(c, wp))*x(c) + 0.05_wp*x(2)*x(1) + 0.01_wp*noise
            call random(seed, way(k))
         end associate
      end do
      ! Where they are one-sided differences, the step is smaller, and they are less exact.
      exact = element%nmode == 0 .and. element%kind /= element_kind%plane_stress
      if (.not. exact) u = 0.2_wp*u
      n = size(surface%node)
      allocate (mises(n, 4), flow(n, 4), found_(n, 2), rate(n, 2))
      do k = 1, 4
         call find_stress(surface, solids, mesh, u + step*place(k)*way, memory, mises(:, k), &
            & flow(:, k))
      end do
      rate(:, 1) = (mises(:, 1) - 8.0_wp*mises(:, 2) + 8.0_wp*mises(:, 3) - mises(:, 4))/12.0_wp
      rate(:, 2) = (flow(:, 1) - 8.0_wp*flow(:, 2) + 8.0_wp*flow(:, 3) - flow(:, 4))/12.0_wp
      rate = rate/step
      call find_stress(surface, solids, mesh, u, memory, mises(:, 1), flow(:, 1))
      call find_slopes(surface, configuration(u), u, spread(.true., 1, n), [.true., .true.], slopes)
      do k = 1, n
         associate (s => slopes(k))
            found_(k, 1) = dot_product(s%mises(:s%n), way(s%dof(:s%n)))
            found_(k, 2) = dot_product(s%flow(:s%n), way(s%dof(:s%n)))
         end associate
      end do
      noise = maxval(abs(rate(:, 1))) + maxval(abs(rate(:, 2)))
      call is_true('stress changes', noise > 0.0_wp)
      call flow_alone_is_the_same(surface, u, way, found_(:, 2), noise)
      call is_true('metal flows', all(flow(:, 1) > 0.0_wp) .or. l <= 2)
      call close_to('mises', found_(:, 1)/noise, rate(:, 1)/noise, merge(1.0e-6_wp, 1.0e-4_wp, &
         & exact))
      call close_to('flow', found_(:, 2)/noise, rate(:, 2)/noise, merge(1.0e-6_wp, 1.0e-4_wp, &
         & exact))
   end subroutine slopes_are_those_of_differences

   !> What is not read is not found, and changes nothing else.
   subroutine flow_alone_is_the_same(surface, u, way, flow, scale)
      type(surface_stress_type), intent(inout) :: surface
      real(wp), contiguous, intent(inout), target :: u(:)
      real(wp), intent(in) :: way(:), flow(:), scale
      type(slopes_type), allocatable :: slopes(:)
      real(wp) :: alone(size(flow)), mises(size(flow)), now(size(flow))
      logical :: once, none
      integer :: j, k

      call find_stress(surface, solids, mesh, u, memory, mises, now)
      call find_slopes(surface, configuration(u), u, spread(.true., 1, size(flow)), &
         & [.false., .true.], slopes)
      once = .true.
      none = .true.
      do k = 1, size(flow)
         associate (s => slopes(k))
            alone(k) = dot_product(s%flow(:s%n), way(s%dof(:s%n)))
            once = once .and. all([(count(s%dof(:s%n) == s%dof(j)) == 1, j=1, s%n)])
            none = none .and. all(abs(s%mises(:s%n)) <= 0.0_wp)
         end associate
      end do
      call is_true('each dof once', once)
      call is_true('nothing else', none)
      call close_to('flow alone', alone/scale, flow/scale, 1.0e-12_wp)
   end subroutine flow_alone_is_the_same

   function configuration(u) result(shape)
      real(wp), contiguous, intent(in), target :: u(:)
      type(configuration_type) :: shape

      shape%solids => solids
      shape%mesh => mesh
      shape%u => u
      shape%memory => memory
   end function configuration
end program test_surface_slopes
