program test_assemble_nonlinear
   use lopin_shared_work, only : set_threads_of_run
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_assemble_nonlinear, only : assemble_nonlinear, bad_element_type
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_recover_stress, only : recover_stress
   use lopin_state, only : solids_state_type
   use lopin_solid_memory, only : new_solid_memory
   use distinct_elements, only : stands_for_another
   use blocks, only : new_block, random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp
   real(wp) :: poisson = 0.3_wp, shear, bulk
   character(len=4), parameter :: wishes(2) = [character(len=4) :: '', 'FULL']
   character(len=9), parameter :: laws(2) = [character(len=9) :: 'Hencky', 'neo-Hooke']
   type(mesh_type) :: mesh
   type(element_type) :: element
   type(solids_type) :: solids
   type(solids_state_type) :: memory
   type(csc_type) :: matrix
   type(bad_element_type) :: bad
   type(error_type), allocatable :: error
   real(wp) :: energy
   integer :: i, j, l
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

   call set_threads_of_run(1)   ! meshes too small to share out
   do i = 1, size(element_words)
      do j = 1, size(wishes)
         if (stands_for_another(trim(element_words(i)), wishes(j))) cycle
         call new_element_type(element, trim(element_words(i)), wishes(j), found)
         if (element%kind == element_kind%rigid) cycle
         do l = 1, size(laws)
            call check_all()
            if (.not. element%patched) cycle
            poisson = 0.45_wp
            call check_all()
            call is_true('patches', solids%patches%n > 0)
            poisson = 0.3_wp
         end do
      end do
   end do
   l = 1
   call two_threads_give_the_same_bits()
   call an_element_turned_inside_out_is_named()
   call a_collapsed_element_is_assembled_right()
   call finish()

contains

   subroutine check_all()
      call make(trim(element_words(i)), [2, 2, 2], 0.2_wp, wishes(j))
      call the_patch_test_passes()
      call small_displacements_have_the_linear_stress()
      call the_matrix_is_the_slope_of_the_force()
   end subroutine check_all

   !> The block [0, 3] x [0, 2] x [0, 1] of a word, equations in the order of the nodes.
   subroutine make(word, boxes, distortion, wish)
      character(len=*), intent(in) :: word, wish
      integer, intent(in) :: boxes(:)
      real(wp), intent(in) :: distortion
      call new_element_type(element, word, wish, found)
      call new_block(mesh, element%cell, boxes, [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 2.0_wp, &
         & 1.0_wp], distortion)
      call number(word, wish)
   end subroutine make

   subroutine number(word, wish)
      character(len=*), intent(in) :: word, wish
      type(solid_section_type) :: section
      integer :: dof(6, mesh%nnode), n, i_
      dof = 0
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = mesh%ndim*(n - 1) + [(i_, i_=1, mesh%ndim)]
      end do
      shear = 0.5_wp*young/(1.0_wp + poisson)
      bulk = young/(3.0_wp - 6.0_wp*poisson)
      section = solid_section_type(wish, young, poisson, 0.5_wp)
      if (l == 2) section = solid_section_type(wish, 0.0_wp, 0.0_wp, 0.5_wp, .true., 0.5_wp*shear, &
         & 2.0_wp/bulk)
      call new_solids(solids, mesh, [word], [section], dof, matrix, error)
      call is_true('no error', .not. allocated(error))
      call new_solid_memory(memory, solids, mesh)
      memory%finite_strain = .true.
   end subroutine number

   !> An affine motion on the skin of a distorted patch; Newton finds that of the inside.
   subroutine the_patch_test_passes()
      real(wp) :: exact(mesh%ndim, mesh%nnode), u(mesh%ndim*mesh%nnode), h(3, 3)
      real(wp), allocatable :: stress(:, :), strain(:, :)

      call test('the patch test passes at finite strain: '//trim(element%word)//' '//laws(l))
      h = reshape([0.3_wp, 0.1_wp, -0.2_wp, 0.4_wp, -0.2_wp, 0.1_wp, 0.2_wp, 0.1_wp, 0.1_wp], &
         & [3, 3])
      if (element%axisymmetric) h(1, 2) = 0.0_wp
      if (element%axisymmetric) h(2, 1) = 0.0_wp
      exact = matmul(h(:mesh%ndim, :mesh%ndim), mesh%x)
      u = reshape(exact, [size(u)])
      call solve_inside(u)
      call close_to('u', u, reshape(exact, [size(u)]), 1.0e-12_wp)
      call recover_nonlinear(solids, mesh, reshape(u, shape(exact)), memory, stress, strain)
      call close_to('stress', stress/young, spread(stress(:, 1), 2, size(stress, 2))/young, &
         & 1.0e-12_wp)
      call close_to('strain', strain, spread(strain(:, 1), 2, size(strain, 2)), 1.0e-12_wp)
   end subroutine the_patch_test_passes

   !> Nodes on the skin keep u; the others start away from balance and are brought to it.
   subroutine solve_inside(u)
      real(wp), intent(inout) :: u(:)
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      logical :: free(size(u))
      integer, allocatable :: inner(:)
      real(wp), allocatable :: full(:, :), rhs(:, :)
      real(wp) :: force(size(u)), move
      integer :: k, a, info, seed, pass

      call boundary_facets(facets, mesh, [element%cell], mesh%element_label, .false., shared)
      free = .true.
      do k = 1, facets%n
         do a = 1, facets%nnode(k)
            free((facets%node(a, k) - 1)*mesh%ndim + 1:facets%node(a, k)*mesh%ndim) = .false.
         end do
      end do
      inner = pack([(k, k=1, size(u))], free)
      call is_true('something is free', size(inner) > 0)
      seed = 11
      do k = 1, size(inner)
         call random(seed, move)
         u(inner(k)) = u(inner(k)) + 0.02_wp*move
      end do
      do pass = 1, 8
         call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad, matrix)
         call is_true('not inside out', bad%element == 0)
         if (allocated(full)) deallocate (full)
         associate (all => dense())
            allocate (full, source=all(inner, inner))
         end associate
         if (allocated(rhs)) deallocate (rhs)
         allocate (rhs(size(inner), 1))
         rhs(:, 1) = -force(inner)
         call dposv('L', size(inner), 1, full, size(inner), rhs, size(inner), info)
         call is_true('positive definite', info == 0)
         if (info /= 0) return
         u(inner) = u(inner) + rhs(:, 1)
         if (maxval(abs(rhs)) < 1.0e-13_wp) exit
      end do
      call is_true('Newton converges', pass <= 8)
   end subroutine solve_inside

   function dense() result(full)
      real(wp) :: full(matrix%n, matrix%n)
      integer :: c, k, r
      full = 0.0_wp
      do c = 1, matrix%n
         do k = matrix%colptr(c) + 1, matrix%colptr(c + 1)
            r = matrix%row(k) + 1
            full(r, c) = matrix%value(k)
            full(c, r) = matrix%value(k)
         end do
      end do
   end function dense

   function wild(size_) result(u)
      real(wp), intent(in) :: size_
      real(wp) :: u(mesh%ndim*mesh%nnode), x(mesh%ndim, mesh%nnode), noise
      integer :: k, seed

      seed = 3
      x = size_*mesh%x
      x(1, :) = x(1, :) + size_*mesh%x(1, :)*mesh%x(2, :)
      u = reshape(x, [size(u)])
      do k = 1, size(u)
         call random(seed, noise)
         u(k) = u(k) + 0.1_wp*size_*noise
      end do
   end function wild

   subroutine small_displacements_have_the_linear_stress()
      real(wp), allocatable :: stress(:, :), strain(:, :), linear(:, :), linear_strain(:, :)
      real(wp), parameter :: small = 1.0e-8_wp
      real(wp) :: u(mesh%ndim, mesh%nnode), force(mesh%ndim*mesh%nnode)
      real(wp), dimension(matrix%n, matrix%n) :: full, linear_k

      call test('small displacements have the linear stress: '//trim(element%word)//' '//laws(l))
      u = reshape(wild(small), shape(u))
      call recover_nonlinear(solids, mesh, u, memory, stress, strain)
      call recover_stress(solids, mesh, u, linear, linear_strain)
      call close_to('stress', stress/(small*young), linear/(small*young), 1.0e-6_wp)
      call close_to('strain', strain/small, linear_strain/small, 1.0e-6_wp)
      call test('the tangent at rest is the linear matrix: '//trim(element%word)//' '//laws(l))
      call assemble_stiffness(solids, mesh, matrix, error)
      linear_k = dense()
      u = 0.0_wp
      call assemble_nonlinear(solids, mesh, reshape(u, [size(u)]), memory, force, energy, bad, &
         & matrix)
      full = dense()
      call close_to('matrix', full/maxval(linear_k), linear_k/maxval(linear_k), 1.0e-13_wp)
   end subroutine small_displacements_have_the_linear_stress

   subroutine the_matrix_is_the_slope_of_the_force()
      real(wp), dimension(mesh%ndim*mesh%nnode) :: u, way, force, product_, again
      real(wp) :: f(mesh%ndim*mesh%nnode, 4), e(4)
      real(wp), parameter :: step = 1.0e-3_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: k

      call test('the matrix is the slope of the force, and that of the energy: ' &
         & //trim(element%word)//' '//laws(l))
      u = wild(0.1_wp)
      way = wild(-1.0_wp)
      way = way(size(way):1:-1)/maxval(abs(way))
      call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad, matrix)
      call is_true('not inside out', bad%element == 0)
      call matrix%multiply(way, product_)
      do k = 1, 4
         call assemble_nonlinear(solids, mesh, u + step*place(k)*way, memory, f(:, k), e(k), bad)
      end do
      product_ = product_/maxval(abs(product_)) - (f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) &
         & - f(:, 4))/(12.0_wp*step)/maxval(abs(product_))
      call close_to('slope', product_, 0.0_wp*product_, 1.0e-8_wp)
      call close_to('energy', (e(1) - 8.0_wp*e(2) + 8.0_wp*e(3) - e(4))/(12.0_wp*step) &
         & /dot_product(force, way), 1.0_wp, 1.0e-8_wp)
      call assemble_nonlinear(solids, mesh, u, memory, again, e(1), bad)
      call is_true('the same without matrix', all(transfer(again, [1]) == transfer(force, [1])) &
         & .and. e(1) == energy)
   end subroutine the_matrix_is_the_slope_of_the_force

   subroutine two_threads_give_the_same_bits()
      character(len=7), parameter :: words(4) = [character(len=7) :: 'CPE4', 'CAX8R', 'C3D8', &
         & 'C3D10']
      real(wp), allocatable :: one(:), force(:), other(:)
      real(wp) :: first
      integer :: w

      do w = 1, size(words)
         call test('one and two threads give the same bits: '//words(w))
         call make(trim(words(w)), [5, 4, 3], 0.2_wp, '')
         if (allocated(force)) deallocate (force, other)
         allocate (force(matrix%n), other(matrix%n))
         call set_threads_of_run(1)
         call assemble_nonlinear(solids, mesh, wild(0.05_wp), memory, force, first, bad, matrix)
         one = matrix%value
         call set_threads_of_run(2)
         call assemble_nonlinear(solids, mesh, wild(0.05_wp), memory, other, energy, bad, matrix)
         call is_true('not inside out', bad%element == 0)
         call is_true('matrix', all(transfer(one, [1]) == transfer(matrix%value, [1])))
         call is_true('force', all(transfer(force, [1]) == transfer(other, [1])))
         call is_true('energy', all(transfer(first, [1]) == transfer(energy, [1])))
      end do
   end subroutine two_threads_give_the_same_bits

   subroutine an_element_turned_inside_out_is_named()
      real(wp), allocatable :: u(:), force(:)

      call test('the first element turned inside out is named')
      call make('CPE4', [3, 2], 0.0_wp, '')
      allocate (u(matrix%n), source=0.0_wp)
      allocate (force(matrix%n))
      call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad)
      call is_true('none at rest', bad%element == 0 .and. bad%number == 0)
      u(2*12) = -1.5_wp
      call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad, matrix)
      call is_true('element 6, one', bad%element == 6 .and. bad%number == 1)
      call is_true('a point', bad%point >= 1 .and. bad%point <= 4)
      call test('a ring pushed across the axis is named')
      call make('CAX4', [3, 2], 0.0_wp, '')
      u = 0.0_wp
      u(1::2) = -1.1_wp
      call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad)
      call is_true('elements 1 and 4', bad%element == 1 .and. bad%number == 2)
   end subroutine an_element_turned_inside_out_is_named

   !> A node named twice: its rows and columns add, its forces too.
   subroutine a_collapsed_element_is_assembled_right()
      real(wp) :: u(8), force(8), f(8, 4), part(8), e, slope(8, 8)
      real(wp), parameter :: step = 1.0e-3_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      integer :: k, p

      call test('a quad collapsed to a triangle has the slope of its force')
      call make('CPE4', [1, 1], 0.0_wp, '')
      mesh%conn(4, 1) = mesh%conn(3, 1)
      call number('CPE4', '')
      u = wild(0.1_wp)
      call assemble_nonlinear(solids, mesh, u, memory, force, energy, bad, matrix)
      do k = 1, 8
         do p = 1, 4
            part = u
            part(k) = part(k) + step*place(p)
            call assemble_nonlinear(solids, mesh, part, memory, f(:, p), e, bad)
         end do
         slope(:, k) = (f(:, 1) - 8.0_wp*f(:, 2) + 8.0_wp*f(:, 3) - f(:, 4))/(12.0_wp*step)
      end do
      call close_to('matrix', dense()/young, slope/young, 1.0e-8_wp)
   end subroutine a_collapsed_element_is_assembled_right
end program test_assemble_nonlinear
