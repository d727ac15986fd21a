!> Elements that do not lock: a thick tube of nearly incompressible material (benchmark F6).
program test_locking
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_linear_solver, only : matrix_class
   use lopin_solver_cholmod, only : solver_cholmod_type
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_solid_loads, only : add_face_loads
   use distinct_elements, only : stands_for_another
   use blocks, only : new_block
   use check, only : test, close_to, is_true, finish
   implicit none
   type(mesh_type) :: mesh
   type(element_type) :: element
   type(solids_type) :: solids
   type(csc_type) :: matrix
   type(error_type), allocatable :: error
   real(wp), allocatable :: x(:, :)   ! before the block is bent
   real(wp), parameter :: nu(4) = [0.3_wp, 0.49_wp, 0.499_wp, 0.4999_wp]
   real(wp) :: ratio
   integer :: i, k
   logical :: found

   do i = 1, size(element_words)
      if (stands_for_another(trim(element_words(i)), '')) cycle
      call new_element_type(element, trim(element_words(i)), '', found)
      if (element%kind == element_kind%rigid .or. element%kind == element_kind%plane_stress) cycle
      do k = 1, 4
         call test('a thick tube under pressure does not lock: '//element_words(i))
         call solve_tube(trim(element_words(i)), nu(k), ratio)
         call close_to('u_r(a)/exact', ratio, 1.0_wp, merge(0.012_wp, 0.01_wp, nu(k) < 0.4_wp))
      end do
   end do
   call finish()

contains

   subroutine build(word, boxes, low, high, poisson)
      character(len=*), intent(in) :: word
      integer, intent(in) :: boxes(:)
      real(wp), intent(in) :: low(:), high(:), poisson
      integer, allocatable :: dof(:, :)
      integer :: n, j

      call new_element_type(element, word, '', found)
      call new_block(mesh, element%cell, boxes, low, high, 0.0_wp)
      allocate (dof(6, mesh%nnode), source=0)
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = [(mesh%ndim*(n - 1) + j, j=1, mesh%ndim)]
      end do
      call new_solids(solids, mesh, [word], [solid_section_type('', 1.0e3_wp, poisson, 1.0_wp)], &
         & dof, matrix, error)
      if (allocated(x)) deallocate (x)
      allocate (x, source=mesh%x)
   end subroutine build

   !> Quarter tube, or a ring of it: a = 1, b = 2, p = 1, E = 1000, plane strain.
   subroutine solve_tube(word, poisson, ratio)
      character(len=*), intent(in) :: word
      real(wp), intent(in) :: poisson
      real(wp), intent(out) :: ratio    !! u_r(a)/exact, mean over the bore
      real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp), near = 1.0e-9_wp
      real(wp), allocatable :: u(:), force(:)
      logical, allocatable :: fixed(:, :), bore(:)
      integer :: boxes(3), d

      boxes = [8, 12, 1]
      if (element%cell%quadratic) boxes = [4, 6, 1]
      if (element%axisymmetric) then
         call build(word, boxes, [1.0_wp, 0.0_wp], [2.0_wp, 1.0_wp], poisson)
      else
         call build(word, boxes, [1.0_wp, 0.0_wp, 0.0_wp], [2.0_wp, quarter, 0.2_wp], poisson)
         mesh%x(1, :) = x(1, :)*cos(x(2, :))
         mesh%x(2, :) = x(1, :)*sin(x(2, :))
      end if
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('assembled', .not. allocated(error))
      d = mesh%ndim
      allocate (u(matrix%n), force(matrix%n), source=0.0_wp)
      allocate (fixed(d, mesh%nnode), source=.false.)
      bore = x(1, :) < 1.0_wp + near
      call push(bore, force)
      if (element%axisymmetric) then
         fixed(2, :) = x(2, :) < near .or. x(2, :) > 1.0_wp - near
      else
         fixed(1, :) = x(2, :) > quarter - near
         fixed(2, :) = x(2, :) < near
         if (d == 3) fixed(3, :) = x(3, :) < near .or. x(3, :) > 0.2_wp - near
      end if
      call solve(reshape(fixed, [d*mesh%nnode]), force, u)
      ! u_r(a) = (1 + nu)/E p a**2/(b**2 - a**2) ((1 - 2 nu) a + b**2/a)
      ratio = sum(radial(reshape(u, [d, mesh%nnode])), mask=bore)/real(count(bore), wp) &
         & /((1.0_wp + poisson)/1.0e3_wp/3.0_wp*(1.0_wp - 2.0_wp*poisson + 4.0_wp))
   end subroutine solve_tube

   function radial(u) result(r)
      real(wp), intent(in) :: u(:, :)
      real(wp) :: r(size(u, 2))
      r = u(1, :)
      if (.not. element%axisymmetric) r = u(1, :)*cos(x(2, :)) + u(2, :)*sin(x(2, :))
   end function radial

   !> Unit pressure on the faces whose nodes are all marked.
   subroutine push(marked, force)
      logical, intent(in) :: marked(:)
      real(wp), intent(inout) :: force(:)
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      integer, allocatable :: face(:)
      integer :: j

      call boundary_facets(facets, mesh, [element%cell], mesh%element_label, &
         & .false., shared)
      allocate (face, source=pack([(j, j=1, facets%n)], &
         & [(all(marked(facets%node(:facets%nnode(j), j))), j=1, facets%n)]))
      call add_face_loads(solids, mesh, facets%element(face), facets%face(face), &
         & spread(1.0_wp, 1, size(face)), spread([0.0_wp, 0.0_wp, 0.0_wp], 2, size(face)), force)
   end subroutine push

   !> Eliminate the held equations and solve.
   subroutine solve(fixed, force, u)
      logical, intent(in) :: fixed(:)
      real(wp), intent(in) :: force(:)
      real(wp), intent(out) :: u(:)
      type(solver_cholmod_type) :: solver
      real(wp) :: right(size(u), 1)
      integer :: c, j, r, bad

      right(:, 1) = merge(0.0_wp, force, fixed)
      do c = 1, matrix%n
         do j = matrix%colptr(c) + 1, matrix%colptr(c + 1)
            r = matrix%row(j) + 1
            if (fixed(r) .or. fixed(c)) matrix%value(j) = merge(1.0_wp, 0.0_wp, r == c)
         end do
      end do
      call solver%analyse(matrix, matrix_class%positive_definite, [integer ::], error)
      call solver%factorise(matrix, bad, error)
      call is_true('factorised', .not. allocated(error))
      call solver%solve(right)
      u = right(:, 1)
   end subroutine solve
end program test_locking
