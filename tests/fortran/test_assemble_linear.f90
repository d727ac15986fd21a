program test_assemble_linear
   use lopin_shared_work, only : set_threads_of_run
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_solid_small, only : stiffness
   use lopin_solids, only : solids_type, solid_section_type, new_solids, unit_nodes
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_solid_loads, only : add_body_loads, add_face_loads
   use lopin_recover_stress, only : recover_stress, average_to_nodes
   use distinct_elements, only : stands_for_another
   use blocks, only : new_block
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: pi = acos(-1.0_wp)
   character(len=4), parameter :: wishes(2) = [character(len=4) :: '', 'FULL']
   type(mesh_type) :: mesh
   type(element_type) :: element
   type(solids_type) :: solids
   type(csc_type) :: matrix
   type(error_type), allocatable :: error
   real(wp) :: poisson = 0.3_wp
   integer :: i, j
   logical :: found

   interface
      subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         character, intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dposv
   end interface

   do i = 1, size(element_words)
      do j = 1, 2
         if (stands_for_another(trim(element_words(i)), wishes(j))) cycle
         call new_element_type(element, trim(element_words(i)), wishes(j), found)
         if (element%kind == element_kind%rigid) cycle
         if (element%patched) then
            poisson = 0.45_wp
            call make(trim(element_words(i)), [2, 2, 2], 0.2_wp, wishes(j))
            call is_true('patches', solids%patches%n > 0)
            call colours_do_not_touch()
            call the_patch_test_passes()
            call loads_sum_to_weight_and_pressure_closes()
            poisson = 0.3_wp
         end if
         call make(trim(element_words(i)), [2, 2, 2], 0.2_wp, wishes(j))
         call colours_do_not_touch()
         call the_patch_test_passes()
         call loads_sum_to_weight_and_pressure_closes()
      end do
   end do
   call two_threads_give_the_same_bits()
   call a_folded_element_is_named()
   call a_collapsed_element_is_assembled_right()
   call rigid_elements_have_no_stiffness()
   call a_fan_of_many_elements_needs_a_serial_colour()
   call plane_stress_thins()
   call finish()

contains

   !> The block [0, 3] x [0, 2] x [0, 1] of a word, equations in the order of the nodes.
   subroutine make(word, boxes, distortion, wish)
      character(len=*), intent(in) :: word, wish
      integer, intent(in) :: boxes(:)
      real(wp), intent(in) :: distortion
      call new_element_type(element, word, wish, found)
      call new_block(mesh, element%cell, boxes, [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 2.0_wp, &
         & 1.0_wp], distortion)
      call number(word, wish)
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('no error', .not. allocated(error))
   end subroutine make

   subroutine number(word, wish)
      character(len=*), intent(in) :: word, wish
      integer :: dof(6, mesh%nnode), n, i_
      dof = 0
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = mesh%ndim*(n - 1) + [(i_, i_=1, mesh%ndim)]
      end do
      call new_solids(solids, mesh, [word], [solid_section_type(wish, 210.0_wp, poisson, 0.5_wp)], &
         & dof, &
         & matrix, error)
      call is_true('no error', .not. allocated(error))
   end subroutine number

   subroutine colours_do_not_touch()
      integer :: c, k, e, mark(mesh%nnode)
      logical :: touch

      call test('elements of a colour share no node and none is lost: '//element%word)
      call is_true('all', size(solids%order) == units() .and. .not. solids%last_is_serial)
      mark = 0
      touch = .false.
      do c = 1, size(solids%colour_start) - 1
         do k = solids%colour_start(c), solids%colour_start(c + 1) - 1
            e = solids%order(k)
            touch = touch .or. any(mark(unit_nodes(solids, mesh, e)) == c)
            mark(unit_nodes(solids, mesh, e)) = c
         end do
      end do
      call is_true('apart', .not. touch)
   end subroutine colours_do_not_touch

   !> Elements, and patches of elements, that are assembled.
   integer function units()
      units = count(solids%patches%of == 0) + solids%patches%n
   end function units

   !> Prescribe an affine motion on the skin of a distorted patch, solve for the inside.
   subroutine the_patch_test_passes()
      real(wp) :: u(mesh%ndim, mesh%nnode), gradient(3, 3), exact(6)
      real(wp), allocatable :: stress(:, :), strain(:, :), nodal(:, :)
      real(wp), parameter :: e = 210.0_wp
      real(wp) :: nu, lambda, shear
      integer :: k

      nu = poisson
      lambda = e*nu/((1.0_wp + nu)*(1.0_wp - 2.0_wp*nu))
      shear = e/(2.0_wp + 2.0_wp*nu)

      call test('the patch test passes on a distorted patch: '//element%word)
      gradient = reshape([0.3_wp, 0.1_wp, -0.2_wp, 0.4_wp, -0.5_wp, 0.6_wp, 0.7_wp, 0.9_wp, &
         & 1.1_wp], [3, 3])
      if (element%ndim == 2) gradient(:, 3) = 0.0_wp
      if (element%ndim == 2) gradient(3, :) = 0.0_wp
      if (element%kind == element_kind%plane_stress) gradient(3, 3) = -nu/(1.0_wp - nu)*(-0.2_wp)
      if (element%axisymmetric) gradient = reshape([0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp, -0.5_wp, &
         & 0.0_wp, &
         & 0.0_wp, 0.0_wp, 0.3_wp], [3, 3])
      exact = [gradient(1, 1), gradient(2, 2), gradient(3, 3), gradient(1, 2) + gradient(2, 1), &
         & gradient(1, 3) + gradient(3, 1), gradient(2, 3) + gradient(3, 2)]
      if (element%kind == element_kind%plane_stress) exact(3) = -nu/(1.0_wp - nu)*(exact(1) &
         & + exact(2))
      u = matmul(gradient(:mesh%ndim, :mesh%ndim), mesh%x)
      call solve_inside(u)
      call close_to('u', u, matmul(gradient(:mesh%ndim, :mesh%ndim), mesh%x), 1.0e-12_wp)
      call recover_stress(solids, mesh, u, stress, strain)
      allocate (nodal(6, mesh%nnode))
      call average_to_nodes(solids, mesh, stress, nodal)
      call close_to('strain', strain, spread(exact, 2, size(strain, 2)), 1.0e-12_wp)
      exact(4:) = shear*exact(4:)
      exact(:3) = lambda*sum(exact(:3)) + 2.0_wp*shear*exact(:3)
      do k = 1, size(stress, 2)
         call close_to('stress', stress(:, k)/e, exact/e, 1.0e-12_wp)
      end do
      call close_to('nodal stress', nodal/e, spread(exact, 2, mesh%nnode)/e, 1.0e-11_wp)
   end subroutine the_patch_test_passes

   !> Nodes on the skin keep u; the others are set to balance.
   subroutine solve_inside(u)
      real(wp), intent(inout) :: u(:, :)
      type(facets_type) :: facets
      logical, allocatable :: shared(:), free(:)
      integer, allocatable :: inner(:), outer(:)
      real(wp), allocatable :: full(:, :), k11(:, :), rhs(:, :), flat(:)
      integer :: k, info

      call boundary_facets(facets, mesh, [element%cell], mesh%element_label, .false., shared)
      allocate (free(size(u)))
      free = .true.
      do k = 1, facets%n
         do info = 1, facets%nnode(k)
            free((facets%node(info, k) - 1)*mesh%ndim + 1:facets%node(info, k)*mesh%ndim) = .false.
         end do
      end do
      allocate (inner, source=pack([(k, k=1, size(u))], free))
      allocate (outer, source=pack([(k, k=1, size(u))], .not. free))
      call is_true('something is free', size(inner) > 0)
      allocate (full, source=dense())
      allocate (flat, source=reshape(u, [size(u)]))
      allocate (k11, source=full(inner, inner))
      allocate (rhs(size(inner), 1))
      rhs(:, 1) = -matmul(full(inner, outer), flat(outer))
      call dposv('L', size(inner), 1, k11, size(inner), rhs, size(inner), info)
      call is_true('positive definite', info == 0)
      flat(inner) = rhs(:, 1)
      u = reshape(flat, shape(u))
   end subroutine solve_inside

   function dense() result(full)
      real(wp), allocatable :: full(:, :)
      integer :: c, k, r
      allocate (full(matrix%n, matrix%n))
      full = 0.0_wp
      do c = 1, matrix%n
         do k = matrix%colptr(c) + 1, matrix%colptr(c + 1)
            r = matrix%row(k) + 1
            full(r, c) = matrix%value(k)
            full(c, r) = matrix%value(k)
         end do
      end do
   end function dense

   subroutine loads_sum_to_weight_and_pressure_closes()
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      real(wp) :: force(matrix%n), total(3), volume
      integer :: k

      call test('loads sum to the weight, and a pressure all around to nothing: '//element%word)
      force = 0.0_wp
      call add_body_loads(solids, mesh, mesh%element_label, &
         & spread([0.0_wp, -2.0_wp, 0.0_wp], 2, mesh%nelement), force)
      volume = merge(6.0_wp, merge(2.0_wp*pi*9.0_wp, 3.0_wp, element%axisymmetric), mesh%ndim == 3)
      call close_to('weight', sum(force(2::mesh%ndim)), -2.0_wp*volume, 1.0e-12_wp)
      call boundary_facets(facets, mesh, [element%cell], mesh%element_label, element%axisymmetric, &
         & shared)
      force = 0.0_wp
      call add_face_loads(solids, mesh, facets%element, facets%face, spread(3.0_wp, 1, facets%n), &
         & spread([0.0_wp, 0.0_wp, 0.0_wp], 2, facets%n), force)
      total = [(sum(force(k::mesh%ndim)), k=1, 3)]
      ! All around a body of revolution the radial forces squeeze: -p times the integral of 2 pi dA.
      if (element%axisymmetric) total(1) = total(1) + 3.0_wp*2.0_wp*pi*6.0_wp
      call close_to('sum', total(:mesh%ndim), spread(0.0_wp, 1, mesh%ndim), 1.0e-11_wp)
   end subroutine loads_sum_to_weight_and_pressure_closes

   subroutine two_threads_give_the_same_bits()
      character(len=7), parameter :: words(4) = [character(len=7) :: 'CPE4', 'CAX8R', 'C3D8', &
         & 'C3D10']
      real(wp), allocatable :: one(:)
      integer :: w

      do w = 1, size(words)
         call test('one and two threads give the same bits: '//words(w))
         call set_threads_of_run(1)
         call make(trim(words(w)), [5, 4, 3], 0.2_wp, '')
         if (allocated(one)) deallocate (one)
         allocate (one, source=matrix%value)
         call set_threads_of_run(2)
         call make(trim(words(w)), [5, 4, 3], 0.2_wp, '')
         call is_true('bits', all(transfer(one, [1]) == transfer(matrix%value, [1])))
      end do
   end subroutine two_threads_give_the_same_bits

   subroutine a_folded_element_is_named()
      call test('a folded element is named with its label, point and value')
      call make('CPE4', [3, 2], 0.0_wp, '')
      mesh%element_label(4) = 5011
      mesh%conn(:4, 4) = mesh%conn([1, 4, 3, 2], 4)
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('error', allocated(error))
      if (.not. allocated(error)) return
      call is_true(error%text(), index(error%text(), 'E0302: element 5011 (CPE4) is folded') > 0)
      call is_true('value', index(error%text(), '-2.500E-01') > 0)
   end subroutine a_folded_element_is_named

   !> Two nodes in one place and with one number: both mirrored entries belong to the diagonal
   !> block.
   subroutine a_collapsed_element_is_assembled_right()
      real(wp) :: ke(8, 8), exact(6, 6), smallest
      integer :: equation(8), a, b, point

      call test('a quad collapsed to a triangle is the sum of its rows and columns')
      call make('CPE4', [1, 1], 0.0_wp, '')
      mesh%conn(4, 1) = mesh%conn(3, 1)
      call number('CPE4', '')
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('no error', .not. allocated(error))
      call stiffness(solids%group(1)%element, mesh%x(:, mesh%conn(:4, 1)), 0.5_wp, &
         & solids%group(1)%d, ke, &
         & smallest, point)
      equation = [1, 2, 3, 4, 5, 6, 5, 6]
      exact = 0.0_wp
      do a = 1, 8
         do b = 1, 8
            exact(equation(a), equation(b)) = exact(equation(a), equation(b)) + ke(a, b)
         end do
      end do
      associate (full => dense())
         call close_to('matrix', full([1, 2, 3, 4, 7, 8], [1, 2, 3, 4, 7, 8]), exact, 1.0e-13_wp)
      end associate
   end subroutine a_collapsed_element_is_assembled_right

   subroutine rigid_elements_have_no_stiffness()
      integer :: dof(6, 6)
      call test('rigid elements and elements without section add nothing')
      call make('CPE4', [2, 1], 0.0_wp, '')
      mesh%etype(2) = 2
      mesh%section(2) = 0
      dof = 0
      dof(1, :) = [1, 3, 0, 5, 7, 0]
      dof(2, :) = [2, 4, 0, 6, 8, 0]
      call new_solids(solids, mesh, [character(len=4) :: 'CPE4', 'R2D2'], &
         & [solid_section_type('', 210.0_wp, 0.3_wp, 1.0_wp)], dof, matrix, error)
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('8 equations, full triangle', matrix%n == 8 .and. size(matrix%value) == 36)
      call is_true('points of the first only', all(solids%first_point == [1, 5, 5]))
   end subroutine rigid_elements_have_no_stiffness

   subroutine a_fan_of_many_elements_needs_a_serial_colour()
      integer, parameter :: n = 100
      real(wp) :: angle
      integer :: k
      real(wp), allocatable :: one(:)

      call test('a hundred triangles around one node: those past the colours go to one thread')
      call new_element_type(element, 'CPE3', '', found)
      deallocate (mesh%x, mesh%conn)
      mesh%ndim = 2
      mesh%nnode = n + 1
      mesh%nelement = n
      allocate (mesh%x(2, n + 1), mesh%conn(20, n))
      mesh%x(:, n + 1) = 0.0_wp
      do k = 1, n
         angle = 2.0_wp*pi*real(k, wp)/real(n, wp)
         mesh%x(:, k) = [cos(angle), sin(angle)]
         mesh%conn(:3, k) = [n + 1, k, mod(k, n) + 1]
      end do
      mesh%etype = spread(1, 1, n)
      mesh%section = mesh%etype
      mesh%element_label = [(k, k=1, n)]
      call number('CPE3', '')
      call is_true('serial', solids%last_is_serial .and. size(solids%order) == n)
      call set_threads_of_run(1)
      call assemble_stiffness(solids, mesh, matrix, error)
      allocate (one, source=matrix%value)
      call set_threads_of_run(2)
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('bits', all(transfer(one, [1]) == transfer(matrix%value, [1])))
      associate (full => dense())
         call close_to('translation', sum(full(:, 1::2), dim=2)/210.0_wp, spread(0.0_wp, 1, &
            & 2*n + 2), 1.0e-13_wp)
      end associate
   end subroutine a_fan_of_many_elements_needs_a_serial_colour

   subroutine plane_stress_thins()
      real(wp), allocatable :: stress(:, :), strain(:, :)
      call test('a plane-stress plate thins by nu times the uniaxial strain')
      call make('CPS4', [2, 1], 0.0_wp, '')
      call recover_stress(solids, mesh, spread([1.0_wp, -0.3_wp], 2, mesh%nnode)*mesh%x, stress, &
         & strain)
      call close_to('stress', stress(:, 1), [210.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
         & 1.0e-12_wp)
      call close_to('strain', strain(1:3, 1), [1.0_wp, -0.3_wp, -0.3_wp], 1.0e-13_wp)
   end subroutine plane_stress_thins
end program test_assemble_linear
