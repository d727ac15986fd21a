!> Kernels on plain arrays, for comparison with other programs and with independent references.
!>
!> `code` is 0, or 2 for a name or a size that does not exist, 4 for a singular matrix, 3 for
!> contact states that do not settle.
module lopin_probes
   use lopin_active_set, only : contact_result_type, solve_contact, outcome
   use lopin_cells, only : cell_type, new_cell, shape_functions
   use lopin_condensed, only : condensed_type
   use lopin_csc, only : csc_type, storage
   use lopin_dense, only : cholesky
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use lopin_element_type, only : element_type, element_kind, new_element_type
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_error, only : error_type, error_code, nowhere
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis, coefficients_of
   use lopin_kinds, only : wp
   use lopin_linear_solver, only : matrix_class
   use lopin_profile, only : segment_card_type
   use lopin_projection, only : closest_type, project_on_facet, facet_unit_normal, place
   use lopin_solid_small, only : stiffness
   use lopin_solver_skyline, only : solver_skyline_type
   use lopin_tool, only : tool_type, foot_type
   use lopin_tool_factory, only : new_tool_from_segments, new_tool_plane, new_tool_sphere, &
      & new_tool_cylinder
   implicit none
   private
   public :: cell_functions, facet_projection, tool_gaps, skyline_solution, contact_forces, &
      & moduli, element_stiffness

   integer, parameter :: number_a_card = 5   !! 0 START, 1 LINE, 2 CIRCL, 3 PARAB, then its values
   character(len=*), parameter :: card_words(0:3) = [character(len=5) :: 'START', 'LINE', 'CIRCL', &
      & 'PARAB']

contains

   !> Shape functions of a cell and their slopes at one point.
   subroutine cell_functions(name, xi, n, dn, code)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: xi(:)        !! (ndim) parametric point
      real(wp), intent(out) :: n(:)        !! (nnode)
      real(wp), intent(out) :: dn(:, :)    !! (ndim, nnode)
      integer, intent(out) :: code
      type(cell_type) :: cell
      logical :: found

      call new_cell(cell, name, found)
      found = found .and. cell%ndim == size(xi) .and. cell%nnode == size(n)
      code = merge(0, error_code%usage, found)
      n = 0.0_wp
      dn = 0.0_wp
      if (found) call shape_functions(cell, xi, n, dn)
   end subroutine cell_functions

   !> Closest point of one facet.
   subroutine facet_projection(name, x, point, xi, gap, normal, code)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x(:, :)      !! (ndim, nnode) [length]
      real(wp), intent(in) :: point(:)     !! (ndim) [length]
      real(wp), intent(out) :: xi(:)       !! (ndim-1)
      real(wp), intent(out) :: gap         !! along the normal [length]
      real(wp), intent(out) :: normal(:)   !! (ndim)
      integer, intent(out) :: code
      type(cell_type) :: cell
      type(facet_basis_type) :: basis
      type(closest_type) :: closest
      real(wp) :: p(3), slack(4), n(3)
      logical :: found

      xi = 0.0_wp
      gap = 0.0_wp
      normal = 0.0_wp
      call new_cell(cell, name, found)
      found = found .and. cell%ndim == size(point) - 1 .and. cell%nnode == size(x, 2)
      code = merge(0, error_code%usage, found)
      if (.not. found) return
      call new_facet_basis(basis)
      p = 0.0_wp
      p(:size(point)) = point
      slack = 0.0_wp
      associate (c => coefficients_of(basis, cell%id, x))
         call project_on_facet(c, cell%family, basis%centre(:, cell%id), slack, p, closest)
         n = facet_unit_normal(c, cell%family, closest%xi)
      end associate
      if (closest%place == place%none) code = error_code%not_converged
      xi = closest%xi(:size(xi))
      normal = n(:size(normal))
      gap = dot_product(n, p - closest%point)
   end subroutine facet_projection

   !> Gaps to a rigid tool at time 0. `data`: plane: origin, normal; sphere and cavity: centre,
   !> radius; cylinder and bore: two points of the axis, radius; profile: five numbers a card.
   subroutine tool_gaps(kind, data, x, gap, normal, code)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: data(:)         !! [length]
      real(wp), intent(in) :: x(:, :)         !! (ndim, npoint) [length]
      real(wp), intent(out) :: gap(:)         !! (npoint) [length]
      real(wp), intent(out) :: normal(:, :)   !! (ndim, npoint)
      integer, intent(out) :: code
      class(tool_type), allocatable :: tool
      type(error_type), allocatable :: error
      type(foot_type) :: foot
      integer :: i

      gap = 0.0_wp
      normal = 0.0_wp
      code = error_code%usage
      call new_tool(tool, kind, data, size(x, 1), error)
      if (allocated(error)) code = error%code
      if (allocated(error) .or. .not. allocated(tool)) return
      code = 0
      do i = 1, size(gap)
         call tool%project(x(:, i), foot)
         gap(i) = foot%gap
         normal(:, i) = foot%normal(:size(normal, 1))
         if (.not. foot%found) code = error_code%not_converged
      end do
   end subroutine tool_gaps

   subroutine new_tool(tool, kind, data, ndim, error)
      class(tool_type), allocatable, intent(out) :: tool
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: data(:)
      integer, intent(in) :: ndim
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: none(3, 0)
      type(segment_card_type), allocatable :: card(:)
      integer :: i

      select case (kind)
      case ('plane')
         if (size(data) == 2*ndim) call new_tool_plane(tool, data(:ndim), data(ndim + 1:), error)
      case ('sphere', 'cavity')
         if (size(data) == ndim + 1) call new_tool_sphere(tool, data(:ndim), data(ndim + 1), &
            & kind == 'cavity', error)
      case ('cylinder', 'bore')
         if (size(data) == 7 .and. ndim == 3) call new_tool_cylinder(tool, data(:3), &
            & data(4:6) - data(:3), data(7), 0.0_wp, kind == 'bore', error)
      case ('profile')
         allocate (card(size(data)/number_a_card))
         do i = 1, size(card)
            associate (row => data(number_a_card*(i - 1) + 1:number_a_card*i))
               card(i)%word = card_words(max(0, min(3, nint(row(1)))))
               card(i)%value = row(2:)
            end associate
         end do
         if (ndim == 2) call new_tool_from_segments(tool, 'SEGMENTS', none, card, 0.0_wp, nowhere, &
            & error)
      end select
   end subroutine new_tool

   !> Solve with the profile solver.
   subroutine skyline_solution(pointer, row, value, b, x, code)
      integer, intent(in) :: pointer(:)    !! (n+1) columns of the lower triangle, from 1
      integer, intent(in) :: row(:)        !! (nnz) rows from 1
      real(wp), intent(in) :: value(:)     !! (nnz)
      real(wp), intent(in) :: b(:)         !! (n)
      real(wp), intent(out) :: x(:)        !! (n)
      integer, intent(out) :: code
      type(csc_type) :: a
      type(solver_skyline_type) :: solver
      type(error_type), allocatable :: error
      real(wp), allocatable :: columns(:, :)
      integer :: j, k, bad

      x = 0.0_wp
      code = error_code%usage
      if (pointer(1) /= 1 .or. pointer(size(b) + 1) /= size(row) + 1) return
      if (any(row < 1 .or. row > size(b)) .or. any(pointer(2:) < pointer(:size(b)))) return
      call a%new_from_triplets(size(b), storage%symmetric_lower, row, &
         & [((j, k=pointer(j), pointer(j + 1) - 1), j=1, size(b))], value)
      call solver%analyse(a, matrix_class%symmetric_indefinite, [integer ::], error)
      if (.not. allocated(error)) call solver%factorise(a, bad, error)
      code = 0
      if (allocated(error)) code = error%code
      if (code /= 0) return
      columns = reshape(b, [size(b), 1])
      call solver%solve(columns)
      x = columns(:, 1)
   end subroutine skyline_solution

   !> Contact of a body known by its compliance: g = gap + S force, each point by the method.
   subroutine contact_forces(compliance, gap, method, alpha, force, iterations, code)
      real(wp), intent(in) :: compliance(:, :)   !! (n, n) positive definite [length/force]
      real(wp), intent(in) :: gap(:)             !! (n) without forces [length]
      character(len=*), intent(in) :: method     !! lagrange, penalty, perturbed, augmented
      real(wp), intent(in) :: alpha(:)           !! (n) nodal stiffness [force/length]
      real(wp), intent(out) :: force(:)          !! (n)
      integer, intent(out) :: iterations, code
      type(condensed_type) :: problem
      type(contact_result_type) :: result
      real(wp), allocatable :: l(:, :)
      integer :: i, j, n, status
      logical :: settled

      force = 0.0_wp
      iterations = 0
      n = size(gap)
      allocate (problem%group(1))
      call new_enforcement(problem%group(1)%method, method)
      code = error_code%usage
      if (.not. allocated(problem%group(1)%method) .or. n == 0) return
      ! With S = L L^T: a unit stiffness and the rows of L.
      l = compliance
      call cholesky(l, status)
      code = error_code%singular
      if (status /= 0) return
      problem%n = n
      problem%nrow = n
      problem%ngroup = 1
      allocate (problem%l(n, n), problem%c(n, 0), source=0.0_wp)
      do i = 1, n
         problem%l(i, i) = 1.0_wp
      end do
      problem%first = [(1 + i*(i - 1)/2, i=1, n + 1)]
      problem%column = [((j, j=1, i), i=1, n)]
      problem%value = [((l(i, j), j=1, i), i=1, n)]
      allocate (problem%bilateral(n), source=.false.)
      problem%alpha = alpha
      problem%group_first = [1, n + 1]
      problem%max_augmentations = [merge(200, 0, problem%group(1)%method%updates())]
      problem%penetration = [0.0_wp]
      call solve_contact(problem, gap, spread(0.0_wp, 1, n), [real(wp) ::], result)
      settled = result%outcome == outcome%solved
      code = merge(0, error_code%not_converged, settled)
      iterations = result%iterations
      force = result%force
   end subroutine contact_forces

   !> Hooke's matrix: 4 x 4 of a plane kind, 6 x 6 of a solid.
   subroutine moduli(kind, young, poisson, d, code)
      character(len=*), intent(in) :: kind     !! plane strain, plane stress, axisymmetric, 3d
      real(wp), intent(in) :: young            !! [stress]
      real(wp), intent(in) :: poisson
      real(wp), intent(out) :: d(:, :)
      integer, intent(out) :: code

      d = 0.0_wp
      code = merge(0, error_code%usage, size(d, 1) == merge(6, 4, kind == '3d'))
      if (code /= 0) return
      select case (kind)
      case ('plane stress')
         call plane_stress_matrix(young, poisson, d)
      case ('plane strain', 'axisymmetric', '3d')
         call hooke_matrix(young, poisson, d)
      case default
         code = error_code%usage
      end select
   end subroutine moduli

   subroutine element_stiffness(word, formulation, x, elastic, thickness, k, code)
      character(len=*), intent(in) :: word          !! of the deck, such as CAX4
      character(len=*), intent(in) :: formulation   !! '' or FULL
      real(wp), intent(in) :: x(:, :)               !! (ndim, nnode) [length]
      real(wp), intent(in) :: elastic(2)            !! Young's modulus [stress], Poisson's ratio
      real(wp), intent(in) :: thickness             !! of plane kinds [length]
      real(wp), intent(out) :: k(:, :)              !! (ndof, ndof) [force/length]
      integer, intent(out) :: code
      type(element_type) :: element
      real(wp), allocatable :: d(:, :)
      real(wp) :: smallest
      integer :: point
      logical :: found

      k = 0.0_wp
      code = error_code%usage
      call new_element_type(element, word, formulation, found)
      if (.not. found .or. element%ndof /= size(k, 1)) return
      if (element%ndim /= size(x, 1) .or. element%nnode /= size(x, 2)) return
      allocate (d(element%nstress, element%nstress))
      if (element%kind == element_kind%plane_stress) then
         call plane_stress_matrix(elastic(1), elastic(2), d)
      else
         call hooke_matrix(elastic(1), elastic(2), d)
      end if
      call stiffness(element, x, thickness, d, k, smallest, point)
      code = 0
      if (.not. smallest > 0.0_wp) code = error_code%deck
   end subroutine element_stiffness
end module lopin_probes
