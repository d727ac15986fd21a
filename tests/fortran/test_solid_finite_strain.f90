program test_solid_finite_strain
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_kind, &
      & element_formulation, new_element_type
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use lopin_solid_small, only : stiffness
   use lopin_hyperelastic, only : solid_law_type, hencky_law, green_law, neo_hooke_law
   use element_calls, only : element_at, stresses_at
   use distinct_elements, only : stands_for_another
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, poisson = 0.3_wp, thickness = 0.7_wp
   real(wp), parameter :: shear = young/2.6_wp, bulk = young/1.2_wp
   ! KEPT: as of a material that keeps its volume.
   character(len=4), parameter :: wishes(3) = [character(len=4) :: '', 'FULL', 'KEPT']
   type(element_type) :: element
   type(solid_law_type) :: law, laws(3)
   real(wp) :: memory(0, 64)
   logical :: found
   integer :: i, j, l

   laws = [hencky_law(young, poisson), green_law(young, poisson), &
      & neo_hooke_law(0.5_wp*shear, 2.0_wp/bulk)]
   do i = 1, size(element_words)
      do j = 1, size(wishes)
         if (stands_for_another(trim(element_words(i)), merge(wishes(j), '    ', j < 3))) cycle
         call new_element_type(element, trim(element_words(i)), wishes(j), found)
         if (j == 3) then
            call new_element_type(element, trim(element_words(i)), '', found)
            if (.not. element%projectable) cycle
            element%formulation = element_formulation%projected
         end if
         if (element%kind == element_kind%rigid) cycle
         do l = 1, size(laws)
            law = laws(l)
            call tangent_is_the_slope_of_the_force()
            call force_is_the_slope_of_the_energy()
            call rotations_need_no_force_and_turn_the_rest()
            call affine_deformations_have_uniform_stress()
            call small_strains_are_those_of_the_linear_element()
            call units_do_not_matter()
         end do
      end do
   end do
   call finish()

contains

   !> A distorted element with straight edges, off the axis.
   function distorted() result(x)
      real(wp) :: x(element%ndim, element%nnode), move
      integer :: a, k, seed

      seed = 7
      x = element%cell%xi(:element%ndim, :element%nnode)
      do a = 1, element%cell%ncorner
         do k = 1, element%ndim
            call random(seed, move)
            x(k, a) = x(k, a) + 0.15_wp*move
         end do
      end do
      do a = element%cell%ncorner + 1, element%nnode
         k = a - element%cell%ncorner
         x(:, a) = 0.5_wp*(x(:, element%cell%edge(1, k)) + x(:, element%cell%edge(2, k)))
      end do
      if (element%axisymmetric) x(1, :) = x(1, :) + 3.0_wp
   end function distorted

   !> Large displacements: stretches from 0.6 to 1.5, shear, and noise.
   function wild() result(u)
      real(wp) :: u(element%ndim, element%nnode), x(element%ndim, element%nnode), h(3, 3), noise
      integer :: a, k, seed

      seed = 23
      x = distorted()
      h = reshape([0.4_wp, 0.3_wp, -0.1_wp, -0.2_wp, -0.3_wp, 0.1_wp, 0.3_wp, 0.2_wp, 0.1_wp], &
         & [3, 3])
      if (element%axisymmetric) h(1, 2) = 0.1_wp
      u = matmul(h(:element%ndim, :element%ndim), x)
      do a = 1, element%nnode
         do k = 1, element%ndim
            call random(seed, noise)
            u(k, a) = u(k, a) + 0.03_wp*noise
         end do
      end do
   end function wild

   subroutine force_at(x, u, force)
      real(wp), intent(in) :: x(:, :), u(:, :)
      real(wp), intent(out) :: force(:)
      real(wp) :: energy
      integer :: bad
      call element_at(.true., element, law, x, u, thickness, memory, 1.0_wp, force, energy, bad)
      call is_true('not inside out', bad == 0)
   end subroutine force_at

   !> Against central differences of fourth order.
   subroutine tangent_is_the_slope_of_the_force()
      integer, parameter :: nway = 4           ! none of them leaves out an entry of the matrix
      real(wp), dimension(element%ndim, element%nnode) :: x, u, way
      real(wp) :: ke(element%ndof, element%ndof), force(element%ndof), energy, f(element%ndof, 4)
      real(wp), dimension(element%ndof, nway) :: slope, found_
      real(wp), parameter :: step = 2.0e-4_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: bad, a, k, s, w, seed

      call test('the tangent is the slope of the force: '//element%word//wishes(j))
      x = distorted()
      u = wild()
      call element_at(.true., element, law, x, u, thickness, memory, 1.0_wp, force, energy, bad, ke)
      call is_true('not inside out', bad == 0)
      seed = 41
      do w = 1, nway
         do a = 1, element%nnode
            do k = 1, element%ndim
               call random(seed, way(k, a))
            end do
         end do
         do s = 1, 4
            call force_at(x, u + step*place(s)*way, f(:, s))
         end do
         slope(:, w) = (f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) - f(:, 4))/(12.0_wp*step)
         found_(:, w) = matmul(ke, reshape(way, [element%ndof]))
      end do
      call close_to('ke', found_/maxval(abs(ke)), slope/maxval(abs(ke)), 1.0e-8_wp)
      call close_to('symmetry', maxval(abs(ke - transpose(ke))), 0.0_wp, 0.0_wp)
      call force_at(x, u, f(:, 1))
      call close_to('force alone', maxval(abs(f(:, 1) - force)), 0.0_wp, 0.0_wp)
   end subroutine tangent_is_the_slope_of_the_force

   subroutine force_is_the_slope_of_the_energy()
      real(wp), dimension(element%ndim, element%nnode) :: x, u, moved
      real(wp) :: force(element%ndof), none(element%ndof), energy(4), slope(element%ndof)
      real(wp), parameter :: step = 1.0e-3_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: bad, a, k, s

      call test('the force is the slope of the energy: '//element%word//wishes(j))
      x = distorted()
      u = wild()
      call force_at(x, u, force)
      do a = 1, element%nnode
         do k = 1, element%ndim
            do s = 1, 4
               moved = u
               moved(k, a) = moved(k, a) + step*place(s)
               call element_at(.true., element, law, x, moved, thickness, memory, 1.0_wp, none, &
                  & energy(s), bad)
            end do
            slope(element%ndim*(a - 1) + k) = (energy(1) - 8.0_wp*energy(2) + 8.0_wp*energy(3) &
               & - energy(4))/(12.0_wp*step)
         end do
      end do
      call close_to('force', force/maxval(abs(force)), slope/maxval(abs(force)), 1.0e-8_wp)
   end subroutine force_is_the_slope_of_the_energy

   function rotation() result(q)
      real(wp) :: q(3, 3)
      real(wp), parameter :: c = cos(1.9_wp), s = sin(1.9_wp)
      q = reshape([c, s, 0.0_wp, -s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (element%ndim == 3) q = matmul(q, reshape([c, 0.0_wp, s, 0.0_wp, 1.0_wp, 0.0_wp, -s, &
         & 0.0_wp, c], [3, 3]))
   end function rotation

   !> Objectivity: a rotation after a deformation turns its forces and leaves its energy.
   subroutine rotations_need_no_force_and_turn_the_rest()
      real(wp), dimension(element%ndim, element%nnode) :: x, u, turned
      real(wp) :: force(element%ndof), other(element%ndim, element%nnode), energy, same, q(3, 3)
      integer :: bad

      if (element%axisymmetric) return
      q = rotation()
      x = distorted()
      associate (d => element%ndim)
         call test('a rotation needs no force: '//element%word//wishes(j))
         call force_at(x, matmul(q(:d, :d), x) - x, force)
         call close_to('force', force/young, spread(0.0_wp, 1, element%ndof), 1.0e-12_wp)
         call test('a rotation turns the forces: '//element%word//wishes(j))
         u = wild()
         call element_at(.true., element, law, x, u, thickness, memory, 1.0_wp, force, energy, bad)
         turned = matmul(q(:d, :d), x + u) - x
         call element_at(.true., element, law, x, turned, thickness, memory, 1.0_wp, other, same, &
            & bad)
         call close_to('force', reshape(other, [element%ndof])/young, &
            & reshape(matmul(q(:d, :d), reshape(force, [d, element%nnode])), &
            & [element%ndof])/young, 1.0e-12_wp)
         call close_to('energy', same/young, energy/young, 1.0e-13_wp)
      end associate
   end subroutine rotations_need_no_force_and_turn_the_rest

   !> Closed forms: stress of an affine deformation from its stretches along the axes, turned.
   subroutine affine_deformations_have_uniform_stress()
      real(wp), dimension(element%ndim, element%nnode) :: x
      real(wp) :: stress(6, element%ngauss), strain(6, element%ngauss), q(3, 3), stretch(3)
      real(wp) :: principal(3), s(3, 3), e(3, 3), exact(6), log_exact(6), f(3, 3)
      integer :: bad, k

      call test('an affine deformation has its closed-form stress: '//element%word//wishes(j))
      x = distorted()
      stretch = [1.5_wp, 0.6_wp, 1.0_wp]
      if (element%axisymmetric) stretch(3) = stretch(1)
      if (element%ndim == 3) stretch(3) = 1.2_wp
      if (element%kind == element_kind%plane_stress) stretch(3) = thinned(stretch)
      call closed_form(stretch, principal)
      q = rotation()
      if (element%axisymmetric) q = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      f = spread(stretch, 2, 3)*transpose(q)
      f = matmul(q, f)
      s = matmul(q, spread(principal, 2, 3)*transpose(q))
      e = matmul(q, spread(log(stretch), 2, 3)*transpose(q))
      exact = [s(1, 1), s(2, 2), s(3, 3), s(1, 2), s(1, 3), s(2, 3)]
      log_exact = [e(1, 1), e(2, 2), e(3, 3), 2.0_wp*e(1, 2), 2.0_wp*e(1, 3), 2.0_wp*e(2, 3)]
      call stresses_at(.true., element, law, x, matmul(f(:element%ndim, :element%ndim), x) - x, &
         & thickness, memory, 1.0_wp, stress, strain, bad)
      call is_true('not inside out', bad == 0)
      do k = 1, element%ngauss
         call close_to('stress', stress(:, k)/young, exact/young, 1.0e-12_wp)
         call close_to('strain', strain(:, k), log_exact, 1.0e-12_wp)
      end do
   end subroutine affine_deformations_have_uniform_stress

   !> Cauchy stresses of principal stretches.
   subroutine closed_form(stretch, principal)
      real(wp), intent(in) :: stretch(3)
      real(wp), intent(out) :: principal(3)
      real(wp) :: volume

      volume = product(stretch)
      if (l == 1) then
         principal = ((bulk - 2.0_wp/3.0_wp*shear)*log(volume) + 2.0_wp*shear*log(stretch))/volume
      else if (l == 2) then
         principal = (0.5_wp*(bulk - 2.0_wp/3.0_wp*shear)*(sum(stretch**2) - 3.0_wp) &
            & + shear*(stretch**2 - 1.0_wp))*stretch**2/volume
      else
         principal = shear*volume**(-5.0_wp/3.0_wp)*(stretch**2 - sum(stretch**2)/3.0_wp) &
            & + bulk*(volume - 1.0_wp)
      end if
   end subroutine closed_form

   !> Stretch through the thickness that leaves it free, by bisection.
   real(wp) function thinned(stretch) result(middle)
      real(wp), intent(in) :: stretch(3)
      real(wp) :: low, high, principal(3)
      integer :: k

      low = 0.3_wp
      high = 3.0_wp
      do k = 1, 80
         middle = 0.5_wp*(low + high)
         call closed_form([stretch(1), stretch(2), middle], principal)
         if (principal(3) > 0.0_wp) high = middle
         if (principal(3) <= 0.0_wp) low = middle
      end do
   end function thinned

   subroutine small_strains_are_those_of_the_linear_element()
      real(wp), dimension(element%ndim, element%nnode) :: x, u
      real(wp) :: d(element%nstress, element%nstress), linear(element%ndof, element%ndof)
      real(wp) :: ke(element%ndof, element%ndof), force(element%ndof), energy, smallest
      real(wp), parameter :: small = 1.0e-9_wp
      integer :: bad, point

      call test('at rest the tangent is the linear stiffness: '//element%word//wishes(j))
      x = distorted()
      if (element%kind == element_kind%plane_stress) then
         call plane_stress_matrix(young, poisson, d)
      else
         call hooke_matrix(young, poisson, d)
      end if
      call stiffness(element, x, thickness, d, linear, smallest, point)
      u = 0.0_wp
      call element_at(.true., element, law, x, u, thickness, memory, 1.0_wp, force, energy, bad, ke)
      call close_to('ke', ke/maxval(linear), linear/maxval(linear), 1.0e-13_wp)
      call close_to('force', maxval(abs(force)) + abs(energy), 0.0_wp, 0.0_wp)
      call test('tiny displacements have the linear forces: '//element%word//wishes(j))
      u = small*wild()
      call force_at(x, u, force)
      associate (expected => matmul(linear, reshape(u, [element%ndof])))
         call close_to('force', force/maxval(abs(expected)), expected/maxval(abs(expected)), &
            & 10.0_wp*small)
      end associate
   end subroutine small_strains_are_those_of_the_linear_element

   !> Lengths in metres, stresses in another unit: forces scale.
   subroutine units_do_not_matter()
      real(wp), dimension(element%ndim, element%nnode) :: x, u
      real(wp) :: ke(element%ndof, element%ndof), other(element%ndof, element%ndof), energy
      real(wp) :: force(element%ndof), scaled(element%ndof), factor
      type(solid_law_type) :: mine
      integer :: bad
      real(wp), parameter :: unit = 1.0e-3_wp, press = 1.0e6_wp

      call test('units do not matter: '//element%word//wishes(j))
      x = distorted()
      u = wild()
      call element_at(.true., element, law, x, u, thickness, memory, 1.0_wp, force, energy, bad, ke)
      mine = law
      mine%shear = press*law%shear
      mine%bulk = press*law%bulk
      call element_at(.true., element, mine, unit*x, unit*u, unit*thickness, memory, 1.0_wp, &
         & scaled, energy, bad, other)
      factor = press*unit**2
      call close_to('force', scaled/factor/young, force/young, 1.0e-11_wp)
      call close_to('ke', other/(press*unit)/young, ke/young, 1.0e-11_wp)
   end subroutine units_do_not_matter
end program test_solid_finite_strain
