program test_follower_loads
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_solid_loads, only : add_face_loads
   use lopin_local_matrix, only : local_matrix_type
   use lopin_follower_loads, only : add_follower_loads
   use distinct_elements, only : stands_for_another
   use blocks, only : new_block, random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: pi = acos(-1.0_wp), pressure = 3.0_wp
   type(mesh_type) :: mesh
   type(element_type) :: element
   type(solids_type) :: solids
   type(csc_type) :: matrix
   type(facets_type) :: facets
   type(error_type), allocatable :: error
   integer :: i
   logical :: found

   do i = 1, size(element_words)
      if (stands_for_another(trim(element_words(i)), '')) cycle
      call new_element_type(element, trim(element_words(i)), '', found)
      if (element%kind == element_kind%rigid) cycle
      call make(trim(element_words(i)))
      call at_rest_it_is_the_dead_load()
      call the_matrix_is_the_slope()
      call a_turned_body_has_turned_forces()
      call a_pressure_all_around_does_the_work_of_the_volume()
   end do
   call fixed_and_repeated_nodes()
   call finish()

contains

   subroutine make(word)
      character(len=*), intent(in) :: word
      logical, allocatable :: shared(:)
      integer, allocatable :: dof(:, :)
      integer :: n, i_

      call new_block(mesh, element%cell, [2, 2, 2], [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 2.0_wp, &
         & 1.0_wp], 0.2_wp)
      allocate (dof(6, mesh%nnode), source=0)
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = mesh%ndim*(n - 1) + [(i_, i_=1, mesh%ndim)]
      end do
      call new_solids(solids, mesh, [word], [solid_section_type('', 210.0_wp, 0.3_wp, 0.5_wp)], &
         & dof, matrix, error)
      call is_true('no error', .not. allocated(error))
      call boundary_facets(facets, mesh, [element%cell], mesh%element_label, element%axisymmetric, &
         & shared)
   end subroutine make

   function wild() result(u)
      real(wp) :: u(matrix%n)
      integer :: k, seed
      seed = 5
      do k = 1, size(u)
         call random(seed, u(k))
      end do
      u = 0.15_wp*u
   end function wild

   subroutine push(u, force, local)
      real(wp), intent(in) :: u(:)
      real(wp), intent(out) :: force(:)
      type(local_matrix_type), allocatable, intent(out), optional :: local(:)
      force = 0.0_wp
      call add_follower_loads(solids, mesh, u, facets%element, facets%face, &
         & spread(pressure, 1, facets%n), force, local)
   end subroutine push

   subroutine at_rest_it_is_the_dead_load()
      real(wp) :: force(matrix%n), dead(matrix%n)
      call test('at rest a follower pressure is the dead one: '//element%word)
      dead = 0.0_wp
      call push(dead, force)
      call add_face_loads(solids, mesh, facets%element, facets%face, &
         & spread(pressure, 1, facets%n), spread([0.0_wp, 0.0_wp, 0.0_wp], 2, facets%n), dead)
      call close_to('force', force, dead, 1.0e-13_wp)
   end subroutine at_rest_it_is_the_dead_load

   subroutine the_matrix_is_the_slope()
      real(wp) :: u(matrix%n), way(matrix%n), f(matrix%n, 4), force(matrix%n), slope(matrix%n)
      type(local_matrix_type), allocatable :: local(:)
      real(wp), parameter :: step = 1.0e-2_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: k

      call test('local matrices are the slope of minus the force: '//element%word)
      u = wild()
      way = u(size(u):1:-1)/maxval(abs(u))
      call push(u, force, local)
      do k = 1, 4
         call push(u + step*place(k)*way, f(:, k))
      end do
      slope = 0.0_wp
      do k = 1, size(local)
         slope(local(k)%dof) = slope(local(k)%dof) + matmul(local(k)%k, way(local(k)%dof))
      end do
      call close_to('slope', slope, -(f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) - f(:, 4)) &
         & /(12.0_wp*step), 1.0e-10_wp)
      call push(u, f(:, 1))
      call close_to('without matrices', maxval(abs(f(:, 1) - force)), 0.0_wp, 0.0_wp)
   end subroutine the_matrix_is_the_slope

   subroutine a_turned_body_has_turned_forces()
      real(wp) :: force(mesh%ndim, mesh%nnode), turned(mesh%ndim, mesh%nnode), q(3, 3)
      real(wp) :: f(matrix%n), x(mesh%ndim, mesh%nnode)
      real(wp), parameter :: c = cos(1.9_wp), s = sin(1.9_wp)

      if (element%axisymmetric) return
      call test('a turned body has turned forces: '//element%word)
      q = reshape([c, s, 0.0_wp, -s, c, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (mesh%ndim == 3) q = matmul(q, reshape([c, 0.0_wp, s, 0.0_wp, 1.0_wp, 0.0_wp, -s, &
         & 0.0_wp, c], [3, 3]))
      x = mesh%x + reshape(wild(), shape(x))
      call push(reshape(x - mesh%x, [matrix%n]), f)
      force = reshape(f, shape(force))
      call push(reshape(matmul(q(:mesh%ndim, :mesh%ndim), x) - mesh%x, [matrix%n]), f)
      turned = reshape(f, shape(turned))
      call close_to('force', turned, matmul(q(:mesh%ndim, :mesh%ndim), force), 1.0e-12_wp)
   end subroutine a_turned_body_has_turned_forces

   !> Work on an affine motion grown from rest is minus pressure times the change of volume, and the
   !> matrices of a closed surface are symmetric together.
   subroutine a_pressure_all_around_does_the_work_of_the_volume()
      real(wp) :: h(3, 3), way(matrix%n), force(matrix%n), work, volume, ratio, s
      type(local_matrix_type), allocatable :: local(:)
      real(wp) :: all(matrix%n, matrix%n)
      integer :: k
      real(wp), parameter :: place(3) = [0.5_wp - sqrt(0.15_wp), 0.5_wp, 0.5_wp + sqrt(0.15_wp)], &
         & weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp

      call test('a pressure all around does the work of the change of volume: '//element%word)
      h = reshape([0.4_wp, 0.1_wp, -0.2_wp, 0.3_wp, -0.2_wp, 0.1_wp, 0.2_wp, 0.1_wp, 0.3_wp], &
         & [3, 3])
      if (element%axisymmetric) h(1, 2) = 0.0_wp
      way = reshape(matmul(h(:mesh%ndim, :mesh%ndim), mesh%x), [matrix%n])
      work = 0.0_wp
      do k = 1, 3
         s = place(k)
         call push(s*way, force)
         work = work + weight(k)*dot_product(force, way)
      end do
      ratio = (1.0_wp + h(1, 1))*(1.0_wp + h(2, 2)) - h(1, 2)*h(2, 1)
      volume = 3.0_wp
      if (element%axisymmetric) then
         ratio = ratio*(1.0_wp + h(1, 1))
         volume = 2.0_wp*pi*9.0_wp
      else if (mesh%ndim == 3) then
         h(1, 1) = h(1, 1) + 1.0_wp
         h(2, 2) = h(2, 2) + 1.0_wp
         h(3, 3) = h(3, 3) + 1.0_wp
         ratio = h(1, 1)*(h(2, 2)*h(3, 3) - h(2, 3)*h(3, 2)) &
            & - h(1, 2)*(h(2, 1)*h(3, 3) - h(2, 3)*h(3, 1)) &
            & + h(1, 3)*(h(2, 1)*h(3, 2) - h(2, 2)*h(3, 1))
         volume = 6.0_wp
      end if
      call close_to('work', work, -pressure*volume*(ratio - 1.0_wp), 1.0e-12_wp)
      way = wild()
      if (element%axisymmetric) then
         do k = 1, mesh%nnode
            if (mesh%x(1, k) <= 0.0_wp) way(2*k - 1) = 0.0_wp
         end do
      end if
      call push(way, force, local)
      all = 0.0_wp
      do k = 1, size(local)
         all(local(k)%dof, local(k)%dof) = all(local(k)%dof, local(k)%dof) + local(k)%k
      end do
      if (element%axisymmetric) then   ! nodes of the axis stay on it
         do k = 1, mesh%nnode
            if (mesh%x(1, k) <= 0.0_wp) all(2*k - 1, :) = 0.0_wp
            if (mesh%x(1, k) <= 0.0_wp) all(:, 2*k - 1) = 0.0_wp
         end do
      end if
      call close_to('symmetry', all, transpose(all), 1.0e-12_wp)
   end subroutine a_pressure_all_around_does_the_work_of_the_volume

   subroutine fixed_and_repeated_nodes()
      type(local_matrix_type), allocatable :: local(:)
      integer :: dof(6, 4)
      real(wp) :: force(6), none(6)

      call test('nodes without equation are left out, nodes named twice counted once')
      call new_element_type(element, 'CPE4', '', found)
      call new_block(mesh, element%cell, [1, 1], [0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp], 0.0_wp)
      dof = 0
      dof(:2, 2) = [1, 2]
      dof(:2, 3) = [3, 4]
      dof(:2, 4) = [5, 6]
      call new_solids(solids, mesh, ['CPE4'], [solid_section_type('', 210.0_wp, 0.3_wp, 0.5_wp)], &
         & dof, matrix, error)
      force = 0.0_wp
      none = 0.0_wp
      call add_follower_loads(solids, mesh, none, [1], [1], [1.0_wp], force, local)
      call is_true('two equations', size(local(1)%dof) == 2 .and. local(1)%nu == 2)
      call close_to('force', force, [0.0_wp, 0.25_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 1.0e-15_wp)
      mesh%conn(2, 1) = 3
      mesh%conn(1, 1) = 3
      call add_follower_loads(solids, mesh, none, [1], [1], [1.0_wp], force, local)
      call is_true('one node', size(local(1)%dof) == 2)
   end subroutine fixed_and_repeated_nodes
end program test_follower_loads
