!> Orders of convergence against a manufactured solution, and volumetric locking of a thick tube.
program test_convergence
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_cells, only : shape_functions
   use lopin_quadrature, only : rule_type, new_rule
   use lopin_element_type, only : element_type, new_element_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_solid_small, only : strain_matrices
   use lopin_linear_solver, only : matrix_class
   use lopin_solver_cholmod, only : solver_cholmod_type
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_solid_loads, only : add_face_loads
   use blocks, only : new_block
   use check, only : test, close_to, is_true, finish
   implicit none
   character(len=6), parameter :: words(24) = [character(len=6) :: 'CPE3', 'CPE4', 'CPE6', 'CPE8', &
      & 'CPE8R', &
      & 'CPS4', 'CPS8R', 'CAX3', 'CAX4', 'CAX6', 'CAX8', 'CAX8R', 'C3D4', 'C3D6', 'C3D8', 'C3D10', &
      & 'C3D15', &
      & 'C3D20', 'C3D20R', 'CPS6', 'CPE4I', 'CPS4I', 'CAX4I', 'C3D8I']
   type(mesh_type) :: mesh
   type(solids_type) :: solids
   type(csc_type) :: matrix
   type(error_type), allocatable :: error
   integer :: i

   do i = 1, size(words)
      call orders_are_optimal(trim(words(i)), '')
   end do
   call orders_are_optimal('CPE4', 'FULL')
   call orders_are_optimal('C3D8', 'FULL')
   call thick_tube_locks_as_known()
   call finish()

contains

   subroutine orders_are_optimal(word, wish)
      character(len=*), intent(in) :: word, wish
      real(wp) :: l2(2), h1(2), order(2)
      integer :: boxes, k

      call test('error falls by h**(p+1), that of the gradient by h**p: '//word//' '//wish)
      do k = 1, 2
         call probe(word, wish, boxes)
         boxes = boxes*k
         call solve_manufactured(word, wish, boxes, l2(k), h1(k))
      end do
      order = log([l2(1)/l2(2), h1(1)/h1(2)])/log(2.0_wp)
      associate (p => merge(2.0_wp, 1.0_wp, solids%group(1)%element%cell%quadratic))
         if (order(1) < p + 0.8_wp .or. order(2) < p - 0.15_wp) print '(2a,2f8.3)', word, wish, &
            & order
         call is_true('order of u', order(1) > p + 0.8_wp)
         call is_true('order of its gradient', order(2) > p - 0.15_wp)
      end associate
   end subroutine orders_are_optimal

   !> Boxes of the coarse mesh: enough to be in the asymptotic range.
   subroutine probe(word, wish, boxes)
      character(len=*), intent(in) :: word, wish
      integer, intent(out) :: boxes
      type(element_type) :: element
      logical :: found
      call new_element_type(element, word, wish, found)
      boxes = merge(5, 10, element%cell%quadratic)
      if (element%ndim == 3) boxes = merge(3, 6, element%cell%quadratic)
   end subroutine probe

   subroutine build(word, wish, boxes, low, high, poisson)
      character(len=*), intent(in) :: word, wish
      integer, intent(in) :: boxes(:)
      real(wp), intent(in) :: low(:), high(:), poisson
      type(element_type) :: element
      logical :: found
      integer, allocatable :: dof(:, :)
      integer :: n, k

      call new_element_type(element, word, wish, found)
      call new_block(mesh, element%cell, boxes, low, high, 0.0_wp)
      allocate (dof(6, mesh%nnode))
      dof = 0
      do n = 1, mesh%nnode
         dof(:mesh%ndim, n) = [(mesh%ndim*(n - 1) + k, k=1, mesh%ndim)]
      end do
      call new_solids(solids, mesh, [word], [solid_section_type(wish, 1.0e3_wp, poisson, 1.0_wp)], &
         & dof, &
         & matrix, error)
   end subroutine build

   !> u_i = sin(k_i . x + phase_i) and its gradient (i, j) = d u_i / d x_j.
   pure subroutine exact(x, u, gradient)
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: u(3), gradient(3, 3)
      real(wp), parameter :: k(3, 3) = reshape([1.1_wp, 0.7_wp, 0.5_wp, -0.6_wp, 1.3_wp, 0.4_wp, &
         & 0.3_wp, -0.8_wp, 1.2_wp], [3, 3]), phase(3) = [0.3_wp, 0.9_wp, 1.7_wp]
      integer :: a, d
      d = size(x)
      do a = 1, 3
         u(a) = sin(dot_product(k(:d, a), x) + phase(a))
         gradient(a, :) = k(:, a)*cos(dot_product(k(:d, a), x) + phase(a))
      end do
   end subroutine exact

   !> Stress matrix of the exact solution; (3, 3) is the hoop stress if axisymmetric.
   pure subroutine exact_stress(x, s)
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: s(3, 3)
      real(wp) :: u(3), g(3, 3), strain(6), stress(6)

      call exact(x, u, g)
      strain = 0.0_wp
      strain(:2) = [g(1, 1), g(2, 2)]
      strain(4) = g(1, 2) + g(2, 1)
      stress = 0.0_wp
      associate (group => solids%group(1))
         if (group%element%ndim == 3) strain(3) = g(3, 3)
         if (group%element%ndim == 3) strain(5:6) = [g(1, 3) + g(3, 1), g(2, 3) + g(3, 2)]
         if (group%element%axisymmetric) strain(3) = u(1)/x(1)
         stress(:group%element%nstress) = matmul(group%d, strain(:group%element%nstress))
      end associate
      s = reshape([stress(1), stress(4), stress(5), stress(4), stress(2), stress(6), stress(5), &
         & stress(6), &
         & stress(3)], [3, 3])
   end subroutine exact_stress

   !> Minus the divergence of the exact stress, by central differences.
   pure function load_density(x) result(f)
      real(wp), intent(in) :: x(:)
      real(wp) :: f(size(x)), plus(3, 3), minus(3, 3), y(size(x))
      real(wp), parameter :: h = 1.0e-4_wp
      integer :: j

      f = 0.0_wp
      do j = 1, size(x)
         y = x
         y(j) = x(j) + h
         call exact_stress(y, plus)
         y(j) = x(j) - h
         call exact_stress(y, minus)
         f = f - (plus(:size(x), j) - minus(:size(x), j))/(2.0_wp*h)
      end do
      if (solids%group(1)%element%axisymmetric) then
         call exact_stress(x, plus)
         f = f - [plus(1, 1) - plus(3, 3), plus(1, 2)]/x(1)
      end if
   end function load_density

   subroutine solve_manufactured(word, wish, boxes, l2, h1)
      character(len=*), intent(in) :: word, wish
      integer, intent(in) :: boxes
      real(wp), intent(out) :: l2, h1
      type(facets_type) :: facets
      logical, allocatable :: shared(:), fixed(:)
      real(wp), allocatable :: u(:), force(:)
      real(wp) :: value(3), gradient(3, 3)
      integer :: k, n, d

      call build(word, wish, [boxes, boxes, boxes], [0.5_wp, 0.0_wp, 0.0_wp], [1.5_wp, 1.0_wp, &
         & 1.0_wp], 0.3_wp)
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('assembled', .not. allocated(error))
      d = mesh%ndim
      allocate (u(matrix%n), force(matrix%n), fixed(matrix%n))
      call add_load(force)
      fixed = .false.
      call boundary_facets(facets, mesh, [solids%group(1)%element%cell], mesh%element_label, &
         & .false., shared)
      do k = 1, facets%n
         do n = 1, facets%nnode(k)
            fixed(d*(facets%node(n, k) - 1) + 1:d*facets%node(n, k)) = .true.
         end do
      end do
      u = 0.0_wp
      do n = 1, mesh%nnode
         call exact(mesh%x(:, n), value, gradient)
         if (fixed(d*n)) u(d*n - d + 1:d*n) = value(:d)
      end do
      call solve(fixed, force, u)
      call measure(reshape(u, [d, mesh%nnode]), l2, h1)
   end subroutine solve_manufactured

   subroutine add_load(force)
      real(wp), intent(out) :: force(:)
      real(wp), allocatable :: b(:, :, :), volume(:)
      real(wp) :: smallest, f(mesh%ndim), x(mesh%ndim, 20)
      integer :: e, k, a, d, first, point

      d = mesh%ndim
      force = 0.0_wp
      associate (element => solids%group(1)%element)
         allocate (b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss))
         do e = 1, mesh%nelement
            x(:, :element%nnode) = mesh%x(:, mesh%conn(:element%nnode, e))
            call strain_matrices(element, x, 1.0_wp, b, volume, smallest, point)
            do k = 1, element%ngauss
               f = load_density(matmul(x(:, :element%nnode), element%n(:, k)))
               do a = 1, element%nnode
                  first = d*(mesh%conn(a, e) - 1)
                  force(first + 1:first + d) = force(first + 1:first + d) + volume(k)*element%n(a, &
                     & k)*f
               end do
            end do
         end do
      end associate
   end subroutine add_load

   !> Eliminate the prescribed equations in place and solve.
   subroutine solve(fixed, force, u)
      logical, intent(in) :: fixed(:)
      real(wp), intent(in) :: force(:)
      real(wp), intent(inout) :: u(:)
      type(solver_cholmod_type) :: solver
      real(wp) :: x(size(u), 1)
      integer :: c, k, r, bad

      call matrix%multiply(u, x(:, 1))
      x(:, 1) = force - x(:, 1)
      where (fixed) x(:, 1) = u
      do c = 1, matrix%n
         do k = matrix%colptr(c) + 1, matrix%colptr(c + 1)
            r = matrix%row(k) + 1
            if (fixed(r) .or. fixed(c)) matrix%value(k) = merge(1.0_wp, 0.0_wp, r == c)
         end do
      end do
      call solver%analyse(matrix, matrix_class%positive_definite, [integer ::], error)
      call solver%factorise(matrix, bad, error)
      call is_true('factorised', .not. allocated(error))
      call solver%solve(x)
      u = x(:, 1)
   end subroutine solve

   !> Errors in u and in its gradient by a rule of their own.
   subroutine measure(u, l2, h1)
      real(wp), intent(in) :: u(:, :)
      real(wp), intent(out) :: l2, h1
      type(rule_type) :: rule
      real(wp) :: n(20), dn(3, 20), x(3, 20), own(3, 20), value(3), gradient(3, 3), scale
      integer :: e, k, m, d

      d = mesh%ndim
      l2 = 0.0_wp
      h1 = 0.0_wp
      associate (cell => solids%group(1)%element%cell)
         m = cell%nnode
         call new_rule(rule, cell%family, 5)
         do e = 1, mesh%nelement
            x(:d, :m) = mesh%x(:, mesh%conn(:m, e))
            own(:d, :m) = u(:, mesh%conn(:m, e))
            do k = 1, rule%npoint
               call shape_functions(cell, rule%xi(:, k), n(:m), dn(:d, :m))
               call exact(matmul(x(:d, :m), n(:m)), value, gradient)
               ! Boxes are not distorted: every simplex, wedge and brick here is affine.
               scale = rule%weight(k)
               l2 = l2 + scale*sum((value(:d) - matmul(own(:d, :m), &
                  & n(:m)))**2)/real(mesh%nelement, wp)
               h1 = h1 + scale*sum((gradient(:d, :d) - physical(matmul(own(:d, :m), &
                  & transpose(dn(:d, :m))), &
                  & matmul(x(:d, :m), transpose(dn(:d, :m)))))**2)/real(mesh%nelement, wp)
            end do
         end do
      end associate
      l2 = sqrt(l2)
      h1 = sqrt(h1)
   end subroutine measure

   !> a times the inverse of j, by elimination on the columns.
   pure function physical(a, j) result(g)
      real(wp), intent(in) :: a(:, :), j(:, :)
      real(wp) :: g(size(a, 1), size(a, 2)), b(size(j, 1), size(j, 2)), held(size(j, 1))
      integer :: k, c, p

      g = a
      b = j
      do k = 1, size(b, 1)
         p = k - 1 + maxloc(abs(b(k, k:)), dim=1)
         held = b(:, k)
         b(:, k) = b(:, p)
         b(:, p) = held
         held = g(:, k)
         g(:, k) = g(:, p)
         g(:, p) = held
         g(:, k) = g(:, k)/b(k, k)
         b(:, k) = b(:, k)/b(k, k)
         do c = 1, size(b, 2)
            if (c == k) cycle
            g(:, c) = g(:, c) - g(:, k)*b(k, c)
            b(:, c) = b(:, c) - b(:, k)*b(k, c)
         end do
      end do
   end function physical

   !> Benchmark F6: quarter tube, a = 1, b = 2, p = 1, E = 1000, plane strain, 8 x 12 Q4:
   !> u_r(a)/exact.
   subroutine thick_tube_locks_as_known()
      real(wp), parameter :: nu(4) = [0.3_wp, 0.49_wp, 0.499_wp, 0.4999_wp]
      real(wp), parameter :: full(4) = [0.996_wp, 0.959_wp, 0.711_wp, 0.198_wp]
      real(wp), parameter :: bbar(4) = [0.998_wp, 0.9975_wp, 0.9975_wp, 0.9975_wp]
      real(wp) :: ratio
      integer :: k

      do k = 1, 4
         call test('a thick tube under pressure locks with full integration')
         call solve_tube('FULL', nu(k), ratio)
         call close_to('u_r(a)/exact', ratio, full(k), 1.0e-3_wp)
         call test('a thick tube under pressure does not lock with B-bar')
         call solve_tube('', nu(k), ratio)
         call close_to('u_r(a)/exact', ratio, bbar(k), 1.0e-3_wp)
      end do
   end subroutine thick_tube_locks_as_known

   subroutine solve_tube(wish, poisson, ratio)
      character(len=*), intent(in) :: wish
      real(wp), intent(in) :: poisson
      real(wp), intent(out) :: ratio
      real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp)
      real(wp), allocatable :: u(:), force(:), x(:, :)
      logical, allocatable :: fixed(:)
      integer, allocatable :: inner(:)
      integer :: k

      call build('CPE4', wish, [8, 12], [1.0_wp, 0.0_wp], [2.0_wp, quarter], poisson)
      allocate (x, source=mesh%x)
      mesh%x(1, :) = x(1, :)*cos(x(2, :))
      mesh%x(2, :) = x(1, :)*sin(x(2, :))
      call assemble_stiffness(solids, mesh, matrix, error)
      call is_true('assembled', .not. allocated(error))
      allocate (u(matrix%n), force(matrix%n), fixed(matrix%n))
      u = 0.0_wp
      force = 0.0_wp
      allocate (inner, source=[(1 + 8*k, k=0, 11)])
      call add_face_loads(solids, mesh, inner, spread(4, 1, 12), spread(1.0_wp, 1, 12), &
         & spread([0.0_wp, 0.0_wp], 2, 12), force)
      fixed(1::2) = x(2, :) > quarter - 1.0e-9_wp
      fixed(2::2) = x(2, :) < 1.0e-9_wp
      call solve(fixed, force, u)
      ! u_r(a) = (1 + nu)/E p a**2/(b**2 - a**2) ((1 - 2 nu) a + b**2/a)
      ratio = u(1)/((1.0_wp + poisson)/1.0e3_wp/3.0_wp*(1.0_wp - 2.0_wp*poisson + 4.0_wp))
   end subroutine solve_tube
end program test_convergence
