!> Elements whose material flows, at finite and at small strain, from a committed memory.
program test_solid_flowing
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_flow_curve, only : flow_type, table_flow, swift_flow, voce_flow, linear_flow, &
      & give_viscosity
   use lopin_hyperelastic, only : solid_law_type, hencky_law, give_flow
   use lopin_yield_hill, only : hill_yield
   use lopin_material_memory, only : rows_of, strain_at, stress_at, offset_at, temperature_at, &
      & put_map
   use element_calls, only : element_at, stresses_at, remember_at
   use distinct_elements, only : stands_for_another
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, poisson = 0.3_wp, thickness = 0.7_wp, dt = 0.4_wp
   real(wp), parameter :: shear = young/2.6_wp
   character(len=7), parameter :: names(7) = [character(len=7) :: 'table', 'power', 'perzyna', &
      & 'norton', 'hill', 'moving', 'rigid']
   character(len=6), parameter :: kinds(2) = [character(len=6) :: 'finite', 'small']
   type(element_type) :: element
   type(solid_law_type) :: law
   real(wp), allocatable :: memory(:, :)
   logical :: found
   integer :: i, k, l

   do i = 1, size(element_words)
      if (stands_for_another(trim(element_words(i)), '')) cycle
      call new_element_type(element, trim(element_words(i)), '', found)
      if (element%kind == element_kind%rigid) cycle
      do l = 1, size(names)
         if (names(l) == 'rigid' .and. element%kind == element_kind%plane_stress) cycle
         law = flowing(names(l))
         memory = committed()
         do k = 1, size(kinds)
            call tangent_is_the_slope_of_the_force()
            call what_is_kept_has_the_same_stress()
         end do
         call a_turned_history_gives_turned_forces()
      end do
   end do
   call uniaxial_compression()
   call simple_shear_does_not_oscillate()
   call finish()

contains

   function flowing(name) result(law)
      character(len=*), intent(in) :: name
      type(solid_law_type) :: law
      type(flow_type) :: flow

      law = hencky_law(young, poisson)
      select case (name)
      case ('table')
         flow = table_flow([0.0_wp, 0.02_wp, 7.0_wp], [1.0_wp, 1.5_wp, 4.0_wp])
      case ('power')
         flow = swift_flow(2.0_wp, 0.01_wp, 0.2_wp)
         flow%rate = 2.0_wp
         flow%power = 3.0_wp
      case ('hill')
         flow = table_flow([0.0_wp, 0.02_wp, 7.0_wp], [1.0_wp, 1.5_wp, 4.0_wp])
         allocate (law%plastic)
         law%plastic%yield = hill_yield([1.0_wp, 1.3_wp, 0.8_wp, 0.9_wp, 1.2_wp, 0.7_wp])
         law%plastic%axes = axes()
      case ('moving')
         flow = swift_flow(2.0_wp, 0.01_wp, 0.2_wp)
         flow%rate = 2.0_wp
         flow%power = 3.0_wp
         allocate (law%plastic)
         law%plastic%yield = hill_yield(spread(1.0_wp, 1, 6))
         law%plastic%axes = axes()
         law%plastic%kinematic%n = 2
         law%plastic%kinematic%modulus(:2) = [0.7_wp, 0.2_wp]
      case ('perzyna')
         flow = voce_flow(2.0_wp, 1.0_wp, 3.0_wp, 0.2_wp)
         call give_viscosity(flow, 0.5_wp, 0.6_wp)
      case default
         call give_viscosity(flow, 0.8_wp, 0.3_wp)
         flow%rigid = name == 'rigid'
      end select
      call give_flow(law, flow)
   end function flowing

   !> Axes of a material, turned about z; in space about all axes.
   function axes() result(q)
      real(wp) :: q(3, 3)
      real(wp), parameter :: c = cos(0.5_wp), s = sin(0.5_wp)

      q = reshape([c, -s, 0.0_wp, s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (element%ndim == 3) q = matmul(q, reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, c, -s, 0.0_wp, &
         & s, c], [3, 3]))
   end function axes

   function sentence(start) result(text)
      character(len=*), intent(in) :: start
      character(len=:), allocatable :: text
      text = start//': '//trim(element%word)//', '//trim(names(l))//', '//trim(kinds(k))
   end function sentence

   !> A memory of some past: metrics without pattern, strain, stress, heat.
   function committed() result(memory)
      real(wp), allocatable :: memory(:, :)
      real(wp) :: map(3, 3)
      integer :: seed, p, r

      allocate (memory(rows_of(law, element%nstress), element%ngauss), source=0.0_wp)
      seed = 31
      do p = 1, element%ngauss
         do r = 1, element%nstress
            call random(seed, memory(r, p))
         end do
         memory(:element%nstress, p) = 0.1_wp*memory(:element%nstress, p)
         memory(strain_at(element%nstress), p) = 0.2_wp + 0.01_wp*p
         memory(stress_at(element%nstress), p) = 1.3_wp
         memory(offset_at(element%nstress), p) = -0.01_wp
         if (.not. allocated(law%plastic)) cycle
         map = 0.0_wp
         map(1, :2) = memory(1:2, p)
         map(2, :2) = memory(3:4, p)
         map(3, 3) = 0.03_wp
         if (element%ndim == 3) map(1:2, 3) = memory(5:6, p)
         call put_map(memory(:, p), element%nstress, map)
         memory(temperature_at(element%nstress) + 1, p) = 1.3_wp
         if (law%plastic%kinematic%n > 0) memory(temperature_at(element%nstress) + 11 &
            & :temperature_at(element%nstress) + 14, p) = [0.2_wp, -0.1_wp, -0.1_wp, 0.15_wp]
      end do
   end function committed

   function distorted() result(x)
      real(wp) :: x(element%ndim, element%nnode), move
      integer :: a, d, seed

      seed = 7
      x = element%cell%xi(:element%ndim, :element%nnode)
      do a = 1, element%cell%ncorner
         do d = 1, element%ndim
            call random(seed, move)
            x(d, a) = x(d, a) + 0.1_wp*move
         end do
      end do
      do a = element%cell%ncorner + 1, element%nnode
         d = a - element%cell%ncorner
         x(:, a) = 0.5_wp*(x(:, element%cell%edge(1, d)) + x(:, element%cell%edge(2, d)))
      end do
      if (element%axisymmetric) x(1, :) = x(1, :) + 3.0_wp
   end function distorted

   !> Stretches from 0.7 to 1.3, shear, and noise.
   function wild() result(u)
      real(wp) :: u(element%ndim, element%nnode), x(element%ndim, element%nnode), h(3, 3), noise
      integer :: a, d, seed

      seed = 23
      x = distorted()
      h = reshape([0.3_wp, 0.2_wp, -0.1_wp, -0.1_wp, -0.25_wp, 0.1_wp, 0.2_wp, 0.1_wp, 0.1_wp], &
         & [3, 3])
      if (element%axisymmetric) h(1, 2) = 0.1_wp
      u = matmul(h(:element%ndim, :element%ndim), x)
      do a = 1, element%nnode
         do d = 1, element%ndim
            call random(seed, noise)
            u(d, a) = u(d, a) + 0.02_wp*noise
         end do
      end do
      ! Internal modes of a solid with directions find several balances when it is so distorted.
      if (element%nmode > 0 .and. allocated(law%plastic)) u = 0.5_wp*u
   end function wild

   subroutine answer(u, force, ke)
      real(wp), intent(in) :: u(:, :)
      real(wp), intent(out) :: force(:)
      real(wp), intent(out), optional :: ke(:, :)
      real(wp) :: energy
      integer :: bad

      if (kinds(k) == 'finite') then
         call element_at(.true., element, law, distorted(), u, thickness, memory, dt, force, &
            & energy, bad, ke)
      else
         call element_at(.false., element, law, distorted(), u, thickness, memory, dt, force, &
            & energy, bad, ke)
      end if
      call is_true('not inside out', bad == 0)
   end subroutine answer

   !> Against central differences of fourth order along ways in all dofs; symmetric, as that of an
   !> incremental potential.
   subroutine tangent_is_the_slope_of_the_force()
      integer, parameter :: nway = 4           ! none of them leaves out an entry of the matrix
      real(wp), dimension(element%ndim, element%nnode) :: u, way
      real(wp) :: ke(element%ndof, element%ndof), force(element%ndof), f(element%ndof, 4)
      real(wp), dimension(element%ndof, nway) :: slope, found
      real(wp), parameter :: step = 1.0e-4_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: a, d, s, w, seed

      call test(sentence('the tangent is the slope of the force'))
      u = wild()
      call answer(u, force, ke)
      seed = 41
      do w = 1, nway
         do a = 1, element%nnode
            do d = 1, element%ndim
               call random(seed, way(d, a))
            end do
         end do
         do s = 1, 4
            call answer(u + step*place(s)*way, f(:, s))
         end do
         slope(:, w) = (f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) - f(:, 4))/(12.0_wp*step)
         found(:, w) = matmul(ke, reshape(way, [element%ndof]))
      end do
      call close_to('ke', found/maxval(abs(ke)), slope/maxval(abs(ke)), 1.0e-8_wp)
      call close_to('symmetry', maxval(abs(ke - transpose(ke))), 0.0_wp, 0.0_wp)
      call answer(u, f(:, 1))
      call close_to('force alone', maxval(abs(f(:, 1) - force))/maxval(abs(force)), 0.0_wp, &
         & 1.0e-14_wp)
   end subroutine tangent_is_the_slope_of_the_force

   subroutine commit(u)
      real(wp), intent(in) :: u(:, :)
      real(wp) :: work, held
      integer :: bad

      if (kinds(k) == 'finite') then
         call remember_at(.true., element, law, distorted(), u, thickness, dt, memory, work, held, &
            & bad)
      else
         call remember_at(.false., element, law, distorted(), u, thickness, dt, memory, work, &
            & held, bad)
      end if
      call is_true('kept', bad == 0)
   end subroutine commit

   !> Where the rate does not count, a state that has been kept is in balance with the same forces.
   subroutine what_is_kept_has_the_same_stress()
      real(wp) :: force(element%ndof), same(element%ndof), tight
      real(wp), allocatable :: before(:, :)

      if (law%flow%consistency > 0.0_wp .or. law%flow%rate > 0.0_wp) return
      ! Internal modes start from rest, and do not find back to a state that is about to flow.
      if (element%nmode > 0) return
      call test(sentence('what is kept has the same stress'))
      before = memory
      call answer(wild(), force)
      call commit(wild())
      call is_true('has flowed', any(memory(strain_at(element%nstress), :) &
         & > before(strain_at(element%nstress), :) + 0.01_wp))
      call answer(wild(), same)
      ! The stress on axes of the material is that of an increment's potential: it is kept up to the
      ! square of the strain of the increment, here 0.3.
      tight = 1.0e-11_wp
      if (allocated(law%plastic) .and. kinds(k) == 'finite') tight = 5.0e-2_wp
      call close_to('force', same/maxval(abs(force)), force/maxval(abs(force)), tight)
      memory = before
   end subroutine what_is_kept_has_the_same_stress

   !> Two increments, the second turned: the same plastic strain, turned forces.
   subroutine a_turned_history_gives_turned_forces()
      real(wp), dimension(element%ndim, element%nnode) :: x, turned
      real(wp), dimension(element%ndof) :: force, other
      real(wp), allocatable :: before(:, :), straight(:, :)
      real(wp) :: q(3, 3)
      real(wp), parameter :: c = cos(1.9_wp), s = sin(1.9_wp)

      if (element%axisymmetric .or. element%nmode > 0) return
      k = 1
      call test(sentence('a turned history'))
      q = reshape([c, s, 0.0_wp, -s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (element%ndim == 3) q = matmul(q, reshape([c, 0.0_wp, s, 0.0_wp, 1.0_wp, 0.0_wp, -s, &
         & 0.0_wp, c], [3, 3]))
      x = distorted()
      before = memory
      call commit(0.5_wp*wild())
      call commit(wild())
      call answer(1.1_wp*wild(), force)
      straight = memory
      memory = before
      associate (d => element%ndim)
         call commit(0.5_wp*wild())
         call commit(matmul(q(:d, :d), x + wild()) - x)
         turned = matmul(q(:d, :d), x + 1.1_wp*wild()) - x
         call answer(turned, other)
         call close_to('force', other/maxval(abs(force)), reshape(matmul(q(:d, :d), &
            & reshape(force, [d, element%nnode])), [element%ndof])/maxval(abs(force)), 1.0e-10_wp)
      end associate
      call close_to('memory', reshape(memory, [size(memory)]), reshape(straight, [size(memory)]), &
         & 1.0e-10_wp)
      memory = before
   end subroutine a_turned_history_gives_turned_forces

   !> Benchmark E0 at a point: the stretch across is found by bisection.
   subroutine uniaxial_compression()
      real(wp) :: u(2, 4), stress(6, 4), strain(6, 4), low, high, tau, j, across, held
      real(wp), parameter :: e = 200.0e3_wp, y = 700.0_wp, h = 300.0_wp
      integer :: bad, n, increment

      call new_element_type(element, 'CAX4', '', found)
      law = hencky_law(e, 0.3_wp)
      call give_flow(law, linear_flow(y, h))
      call test('compression to 60 % in one and in ten increments (benchmark E0)')
      tau = (y + h*log(2.5_wp))/(1.0_wp + h/e)
      j = exp(-0.4_wp*tau/e)
      do increment = 1, 10, 9
         memory = committed()
         memory = 0.0_wp
         do n = 1, increment
            low = 0.9_wp
            high = 2.0_wp
            do while (high - low > 1.0e-15_wp)
               across = 0.5_wp*(low + high)
               if (across <= low .or. across >= high) exit
               u = pressed(across, 1.0_wp - 0.6_wp*n/increment)
               call stresses_at(.true., element, law, disc(), u, 1.0_wp, memory, 1.0_wp, stress, &
                  & strain, bad)
               if (stress(1, 1) > 0.0_wp) high = across
               if (.not. stress(1, 1) > 0.0_wp) low = across
            end do
            if (n == increment) exit
            call remember_at(.true., element, law, disc(), u, 1.0_wp, 1.0_wp, memory, tau, held, &
               & bad)
            tau = (y + h*log(2.5_wp))/(1.0_wp + h/e)
         end do
         call close_to('logarithmic strain', -strain(2, 1), 0.9162907_wp, 1.0e-7_wp)
         call close_to('Cauchy stress', -stress(2, 1)/975.32405_wp, 1.0_wp, 1.0e-8_wp)
         call close_to('volume', across**2*0.4_wp, 0.9980550_wp, 1.0e-7_wp)
         call close_to('closed form', -stress(2, 1)*j/tau, 1.0_wp, 1.0e-11_wp)
      end do
      call remember_at(.true., element, law, disc(), u, 1.0_wp, 1.0_wp, memory, tau, held, bad)
      call close_to('plastic strain', memory(strain_at(4), 1), 0.9114236_wp, 1.0e-7_wp)
      call close_to('Kirchhoff stress', memory(stress_at(4), 1), 973.42708_wp, 1.0e-5_wp)
   end subroutine uniaxial_compression

   pure function disc() result(x)
      real(wp) :: x(2, 4)
      x = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
   end function disc

   pure function pressed(across, along) result(u)
      real(wp), intent(in) :: across, along
      real(wp) :: u(2, 4)
      u = disc()
      u(1, :) = (across - 1.0_wp)*u(1, :)
      u(2, :) = (along - 1.0_wp)*u(2, :)
   end function pressed

   !> Elastic: 2 asinh(g/2)/sqrt(1 + g^2/4) G. Perfectly plastic: the shear stress stays at Y/sqrt
   !> 3.
   subroutine simple_shear_does_not_oscillate()
      real(wp) :: u(2, 4), stress(6, 4), strain(6, 4), work, before, held
      real(wp), parameter :: g(2) = [1.0_wp, 4.0_wp], exact(2) = [0.860818_wp, 1.291227_wp]
      integer :: bad, n

      call new_element_type(element, 'CPE4', '', found)
      law = hencky_law(young, poisson)
      call test('elastic simple shear (benchmark E0)')
      memory = committed()
      memory = 0.0_wp
      do n = 1, 2
         call stresses_at(.true., element, law, disc(), sheared(g(n)), 1.0_wp, memory(:0, :), &
            & 1.0_wp, stress, strain, bad)
         call close_to('shear', stress(4, 1)/shear, exact(n), 1.0e-6_wp)
      end do
      call test('hardening simple shear to 10 rises at every increment')
      call give_flow(law, linear_flow(1.0_wp, 0.2_wp))
      before = 0.0_wp
      do n = 1, 200
         u = sheared(0.05_wp*n)
         call stresses_at(.true., element, law, disc(), u, 1.0_wp, memory, 1.0_wp, stress, strain, &
            & bad)
         call is_true('rises', stress(4, 1) > before)
         before = stress(4, 1)
         call remember_at(.true., element, law, disc(), u, 1.0_wp, 1.0_wp, memory, work, held, bad)
      end do
      call close_to('small beside it: normal stress', abs(stress(1, 1))/stress(4, 1), 0.0_wp, &
         & 0.05_wp)
      call close_to('shear', stress(4, 1), (1.0_wp + 0.2_wp*memory(strain_at(4), 1))/sqrt(3.0_wp), &
         & 2.0e-3_wp)
      call close_to('strain', memory(strain_at(4), 1), 10.0_wp/sqrt(3.0_wp), 0.02_wp)
   end subroutine simple_shear_does_not_oscillate

   pure function sheared(g) result(u)
      real(wp), intent(in) :: g
      real(wp) :: u(2, 4)
      u = disc()
      u(1, :) = g*u(2, :)
      u(2, :) = 0.0_wp
   end function sheared
end program test_solid_flowing
