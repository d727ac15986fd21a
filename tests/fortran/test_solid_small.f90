program test_solid_small
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_kind, element_formulation, &
      & new_element_type
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_solid_small, only : strain_matrices, stiffness, strains, internal_force, body_force, &
      & face_force, gauss_points
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, poisson = 0.3_wp, pi = acos(-1.0_wp)
   real(wp), parameter :: thickness = 0.7_wp
   character(len=4), parameter :: wishes(2) = [character(len=4) :: '', 'FULL']
   type(facet_rule_type) :: rules(6)
   type(element_type) :: element
   logical :: found
   integer :: i, j

   interface
      subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         import :: wp
         character, intent(in) :: jobz, uplo
         integer, intent(in) :: n, lda, lwork
         real(wp), intent(inout) :: a(lda, *)
         real(wp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsyev
   end interface

   call new_facet_rules(rules)
   do i = 1, size(element_words)
      do j = 1, 2
         call new_element_type(element, trim(element_words(i)), wishes(j), found)
         if (element%kind == element_kind%rigid) cycle
         call affine_motions_have_their_strain()
         call stiffness_is_consistent()
         call uniform_stress_is_held_by_its_tractions()
         call stiffness_turns_and_scales_with_the_element()
         call zero_energy_modes_are_known()
         call pressure_on_each_face_pushes_inward()
         call weight_is_density_times_volume()
      end do
   end do
   call a_folded_element_is_reported()
   call axisymmetric_loads_are_over_the_full_circumference()
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

   function hooke() result(d)
      real(wp) :: d(element%nstress, element%nstress)
      if (element%kind == element_kind%plane_stress) then
         call plane_stress_matrix(young, poisson, d)
      else
         call hooke_matrix(young, poisson, d)
      end if
   end function hooke

   subroutine stiffness_of(x, ke)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(out) :: ke(:, :)
      real(wp) :: smallest
      integer :: point
      call stiffness(element, x, thickness, hooke(), ke, smallest, point)
      call is_true('unfolded', smallest > 0.0_wp)
   end subroutine stiffness_of

   subroutine affine_motions_have_their_strain()
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss), smallest
      real(wp) :: x(element%ndim, element%nnode), strain(element%nstress, element%ngauss)
      real(wp) :: gradient(3, 3), expected(element%nstress)
      integer :: point, k

      call test('an affine motion has its strain at every Gauss point: '//element%word)
      x = distorted()
      gradient = reshape([0.3_wp, 0.1_wp, -0.2_wp, 0.4_wp, -0.5_wp, 0.6_wp, 0.7_wp, 0.9_wp, &
         & 1.1_wp], [3, 3])
      if (element%ndim == 3) then
         expected = [gradient(1, 1), gradient(2, 2), gradient(3, 3), gradient(1, 2) + gradient(2, &
            & 1), &
            & gradient(1, 3) + gradient(3, 1), gradient(2, 3) + gradient(3, 2)]
      else
         expected = [gradient(1, 1), gradient(2, 2), 0.0_wp, gradient(1, 2) + gradient(2, 1)]
      end if
      if (element%axisymmetric) then
         gradient(1, 2) = 0.0_wp
         expected(3:4) = [gradient(1, 1), gradient(2, 1)]
      end if
      call strain_matrices(element, x, thickness, b, volume, smallest, point, hooke())
      call strains(element, b, reshape(matmul(gradient(:element%ndim, :element%ndim), x), &
         & [element%ndof]), &
         & strain)
      do k = 1, element%ngauss
         call close_to('strain', strain(:, k), expected, 1.0e-13_wp)
      end do
   end subroutine affine_motions_have_their_strain

   subroutine stiffness_is_consistent()
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss), smallest
      real(wp) :: x(element%ndim, element%nnode), strain(element%nstress, element%ngauss)
      real(wp) :: ke(element%ndof, element%ndof), u(element%ndof), force(element%ndof), motion(3, &
         & element%nnode)
      integer :: point, k, seed

      x = distorted()
      call stiffness_of(x, ke)
      call test('stiffness is symmetric and equals the force of its own stress: '//element%word)
      call close_to('symmetry', maxval(abs(ke - transpose(ke))), 0.0_wp, 0.0_wp)
      seed = 3
      do k = 1, element%ndof
         call random(seed, u(k))
      end do
      call strain_matrices(element, x, thickness, b, volume, smallest, point, hooke())
      call strains(element, b, u, strain)
      call internal_force(element, b, volume, matmul(hooke(), strain), force)
      ! What holds hourglass motions is no stress.
      if (.not. element%hourglass) call close_to('force', &
         & matmul(ke, u)/young, force/young, 1.0e-12_wp)
      call test('rigid motions need no force: '//element%word)
      do k = 1, 6
         if (.not. allowed(k)) cycle
         motion = 0.0_wp
         if (k <= 3) motion(k, :) = 1.0_wp
         if (k == 4) motion(:2, :) = reshape([-x(2, :), x(1, :)], [2, element%nnode], order=[2, 1])
         if (k == 5) motion(3, :) = x(1, :)
         if (k == 5) motion(1, :) = -x(3, :)
         if (k == 6) motion(3, :) = x(2, :)
         if (k == 6) motion(2, :) = -x(3, :)
         u = reshape(motion(:element%ndim, :), [element%ndof])
         call close_to('force', matmul(ke, u)/young, spread(0.0_wp, 1, element%ndof), 1.0e-12_wp)
      end do
   end subroutine stiffness_is_consistent

   pure logical function allowed(k)
      integer, intent(in) :: k   !! 1..3 translations, 4..6 rotations in xy, xz, yz
      allowed = element%ndim == 3 .or. k == 2 .or. ((k == 1 .or. k == 4) &
         & .and. .not. element%axisymmetric)
   end function allowed

   !> The patch test of one element: internal forces of a uniform stress = its tractions on all
   !> faces.
   subroutine uniform_stress_is_held_by_its_tractions()
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss), smallest
      real(wp) :: x(element%ndim, element%nnode), force(element%ndof), held(element%ndim, &
         & element%nnode)
      real(wp) :: stress(element%nstress), part(element%ndim, element%nnode)
      integer :: point

      call test('a uniform stress is in balance with its tractions on all faces: '//element%word)
      x = distorted()
      if (element%ndim == 3) then
         stress = [2.0_wp, -1.0_wp, 0.5_wp, 0.3_wp, -0.7_wp, 0.9_wp]
      else
         stress = [2.0_wp, -1.0_wp, 0.4_wp, 0.3_wp]
      end if
      if (element%axisymmetric) stress(3:4) = [stress(1), 0.0_wp]
      if (element%kind == element_kind%plane_stress) stress(3) = 0.0_wp
      call strain_matrices(element, x, thickness, b, volume, smallest, point, hooke())
      call internal_force(element, b, volume, spread(stress, 2, element%ngauss), force)
      held = 0.0_wp
      do point = 1, element%cell%nface
         call tractions_of(stress, point, x, part)
         held = held + part
      end do
      call close_to('force', force, reshape(held, [element%ndof]), 1.0e-12_wp)
   end subroutine uniform_stress_is_held_by_its_tractions

   !> Forces of the traction stress.n on a face, column by column of the stress: n_j dA = - pressure
   !> force.
   subroutine tractions_of(stress, face, x, force)
      real(wp), intent(in) :: stress(:), x(:, :)
      integer, intent(in) :: face
      real(wp), intent(out) :: force(:, :)
      real(wp) :: area(element%ndim, element%nnode), s(3, 3)
      real(wp), parameter :: none(3) = 0.0_wp

      s = 0.0_wp
      s(1, 1) = stress(1)
      s(2, 2) = stress(2)
      s(1, 2) = stress(4)
      if (element%ndim == 3) then
         s(3, 3) = stress(3)
         s(1, 3) = stress(5)
         s(2, 3) = stress(6)
      end if
      s(2, 1) = s(1, 2)
      s(3, 1) = s(1, 3)
      s(3, 2) = s(2, 3)
      call face_force(element, rules, face, x, thickness, -1.0_wp, none, area)
      force = matmul(s(:element%ndim, :element%ndim), area)
   end subroutine tractions_of

   subroutine stiffness_turns_and_scales_with_the_element()
      real(wp), dimension(element%ndof, element%ndof) :: ke, other, turn
      real(wp) :: x(element%ndim, element%nnode), q(3, 3)
      real(wp), parameter :: c = cos(0.6_wp), s = sin(0.6_wp)
      integer :: a, d

      d = element%ndim
      x = distorted()
      call stiffness_of(x, ke)
      call test('stiffness in metres is that in millimetres, scaled: '//element%word)
      call stiffness_of(1.0e-3_wp*x, other)
      if (d == 2 .and. .not. element%axisymmetric) other = 1.0e-3_wp*other   ! thickness kept
      call close_to('ke', 1.0e3_wp*other/young, ke/young, 1.0e-11_wp)
      if (element%axisymmetric) return
      call test('the stiffness of a turned element is the turned stiffness: '//element%word)
      q = reshape([c, s, 0.0_wp, -s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (d == 3) q = matmul(q, reshape([c, 0.0_wp, s, 0.0_wp, 1.0_wp, 0.0_wp, -s, 0.0_wp, c], [3, &
         & 3]))
      turn = 0.0_wp
      do a = 1, element%nnode
         turn(d*a - d + 1:d*a, d*a - d + 1:d*a) = q(:d, :d)
      end do
      call stiffness_of(matmul(q(:d, :d), x), other)
      call close_to('ke', other/young, matmul(turn, matmul(ke, transpose(turn)))/young, 1.0e-12_wp)
   end subroutine stiffness_turns_and_scales_with_the_element

   subroutine zero_energy_modes_are_known()
      real(wp) :: ke(element%ndof, element%ndof), value(element%ndof), work(10*element%ndof)
      integer :: info, expected
      logical :: reduced

      call test('zero-energy modes are rigid motions and the known ones: '//element%word)
      call stiffness_of(distorted(), ke)
      call dsyev('N', 'L', element%ndof, ke, element%ndof, value, work, size(work), info)
      expected = merge(6, merge(1, 3, element%axisymmetric), element%ndim == 3)
      reduced = element%formulation == element_formulation%reduced
      if (reduced .and. element%ndim == 3) expected = 12
      if (reduced .and. element%ndim == 2) expected = merge(2, 4, element%axisymmetric)
      call is_true('positive', all(value > -1.0e-12_wp*value(element%ndof)))
      call close_to('number', real(count(value < 1.0e-9_wp*value(element%ndof)), wp), &
         & real(expected, wp), 0.0_wp)
   end subroutine zero_energy_modes_are_known

   !> Sum of the forces of a unit pressure on a face = - area times normal (by the shoelace
   !> formula).
   subroutine pressure_on_each_face_pushes_inward()
      real(wp) :: x(element%ndim, element%nnode), force(element%ndim, element%nnode), total(3), &
         & exact(3)
      real(wp) :: p(3, 4), r
      integer :: face, m, node(4), k

      call test('a pressure gives minus area times outward normal on each face: '//element%word)
      x = distorted()
      do face = 1, element%cell%nface
         m = count([2, 4, 6] >= element%cell%face_cell(face))   ! 3: line, 2: triangle, 1: quad
         m = 5 - m
         node(:m) = element%cell%face_node(:m, face)
         call face_force(element, rules, face, x, thickness, 2.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], &
            & force)
         total = 0.0_wp
         total(:element%ndim) = sum(force, dim=2)
         p = 0.0_wp
         p(:element%ndim, :m) = x(:, node(:m))
         if (element%ndim == 2) then
            r = thickness
            if (element%axisymmetric) r = pi*(p(1, 1) + p(1, 2))
            exact = -2.0_wp*r*[p(2, 2) - p(2, 1), p(1, 1) - p(1, 2), 0.0_wp]
         else
            exact = 0.0_wp
            do k = 1, m
               exact = exact - cross(p(:, k), p(:, mod(k, m) + 1))
            end do
         end if
         call close_to('force', total, exact, 1.0e-12_wp)
      end do
   end subroutine pressure_on_each_face_pushes_inward

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   subroutine weight_is_density_times_volume()
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss), smallest
      real(wp) :: x(element%ndim, element%nnode), force(element%ndim, element%nnode), exact
      real(wp) :: points(element%ndim, element%ngauss)
      integer :: point

      call test('the weight is density times volume and acts at the centroid: '//element%word)
      x = element%cell%xi(:element%ndim, :element%nnode)
      if (element%axisymmetric) x(1, :) = x(1, :) + 3.0_wp
      exact = sum(element%weight)
      points = gauss_points(element, x)
      if (element%axisymmetric) exact = 2.0_wp*pi*dot_product(element%weight, points(1, :))
      if (element%kind <= element_kind%plane_stress) exact = thickness*exact
      call strain_matrices(element, x, thickness, b, volume, smallest, point, hooke())
      call close_to('smallest det J of the reference', smallest, 1.0_wp, 1.0e-13_wp)
      call body_force(element, volume, [0.0_wp, -9.0_wp, 0.0_wp], force)
      call close_to('weight', sum(force(2, :)), -9.0_wp*exact, 1.0e-13_wp)
      call close_to('moment', dot_product(force(2, :), x(1, :)), &
         & -9.0_wp*dot_product(volume, points(1, :)), 1.0e-13_wp)
   end subroutine weight_is_density_times_volume

   subroutine a_folded_element_is_reported()
      real(wp) :: ke(8, 8), x(2, 4), smallest
      integer :: point
      call test('a folded quad reports its worst Gauss point')
      call new_element_type(element, 'CPE4', '', found)
      x = element%cell%xi(:2, :4)
      x(:, 3) = [-0.9_wp, -0.9_wp]
      call stiffness(element, x, 1.0_wp, hooke(), ke, smallest, point)
      call is_true('point 4', smallest < 0.0_wp .and. point == 4)
      x = element%cell%xi(:2, [1, 4, 3, 2])
      call stiffness(element, x, 1.0_wp, hooke(), ke, smallest, point)
      call close_to('clockwise', smallest, -1.0_wp, 1.0e-14_wp)
   end subroutine a_folded_element_is_reported

   subroutine axisymmetric_loads_are_over_the_full_circumference()
      real(wp) :: x(2, 4), force(2, 4)
      call test('unit pressure on the end of a cylinder of radius 2 is 4 pi, on the axis 4 pi/3')
      call new_element_type(element, 'CAX4', '', found)
      x = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
      call face_force(element, rules, 3, x, 1.0_wp, 1.0_wp, [0.0_wp, 0.0_wp], force)
      call close_to('force', force(2, :), [0.0_wp, 0.0_wp, -8.0_wp, -4.0_wp]*pi/3.0_wp, 1.0e-14_wp)
   end subroutine axisymmetric_loads_are_over_the_full_circumference
end program test_solid_small
