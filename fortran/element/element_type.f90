!> Element words of the deck: which cell, which kind, which formulation, tabulated at its Gauss
!> points.
!>
!> A word is prefix (CPE, CPS, CAX, C3D), number of nodes and letters (R, H, I, M; S: one point and
!> hourglass control). Variants that Lopin does not have are read as the nearest formulation, and
!> `note` says so. A word with a digit for each parametric direction behind it, as C3D8I/001 and
!> CPE4I/02, which no deck has, is that of a sheet of so many layers along the direction: more
!> points there. CSS8, the solid shell of Abaqus, is C3D8I/001.
module lopin_element_type
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, new_cell, new_sided_cell, new_cell_of, shape_functions
   use lopin_quadrature, only : rule_type, new_rule, new_layered_rule
   implicit none
   private
   public :: element_type, element_kind, element_formulation, element_words, new_element_type
   public :: cells_of_words

   type :: kinds
      integer :: plane_strain = 1, plane_stress = 2, axisymmetric = 3, solid = 4, rigid = 5
   end type kinds
   type(kinds), parameter :: element_kind = kinds()

   !> bbar: mean dilatation, whatever points the element has; full: no change; reduced: quadratic
   !> with the points of the linear cell; enhanced: internal modes, see module enhanced_modes;
   !> projected: linear dilatation; centre: one point, see module hourglass.
   type :: formulations
      integer :: bbar = 1, full = 2, reduced = 3, enhanced = 4, projected = 5
      integer :: centre = 6
   end type formulations
   type(formulations), parameter :: element_formulation = formulations()

   character(len=*), parameter :: element_words(68) = [character(len=7) :: &
      & 'CPE3', 'CPE3H', 'CPE4', 'CPE4R', 'CPE4H', 'CPE4I', 'CPE4RH', 'CPE4IH', 'CPE6', &
      & 'CPE6H', 'CPE6M', 'CPE6MH', 'CPE8', 'CPE8R', 'CPE8H', 'CPE8RH', 'CPS3', 'CPS4', &
      & 'CPS4R', 'CPS4I', 'CPS6', 'CPS6M', 'CPS8', 'CPS8R', 'CAX3', 'CAX3H', 'CAX4', 'CAX4R', &
      & 'CAX4H', 'CAX4I', 'CAX4RH', 'CAX4IH', 'CAX6', 'CAX6H', 'CAX6M', 'CAX6MH', 'CAX8', &
      & 'CAX8R', 'CAX8H', 'CAX8RH', 'C3D4', 'C3D4H', 'C3D6', 'C3D6H', 'C3D8', 'C3D8R', 'C3D8H', &
      & 'C3D8I', 'C3D8RH', 'C3D8IH', 'C3D10', 'C3D10H', 'C3D10M', 'C3D10MH', 'C3D10I', 'C3D15', &
      & 'C3D15H', 'C3D20', 'C3D20R', 'C3D20H', 'C3D20RH', 'R2D2', 'RAX2', 'R3D3', 'R3D4', &
      & 'C3D6R', 'C3D8RS', 'CSS8']

   !> Everything that is the same for all elements of a word. Many components: tables that every
   !> kernel reads, computed once for each word and only read afterwards.
   type :: element_type
      character(len=7) :: word = ''
      character(len=:), allocatable :: note !! what the user must know of the reading; '' if nothing
      type(cell_type) :: cell
      integer :: kind = 0                     !! one of element_kind
      integer :: formulation = 0              !! one of element_formulation
      logical :: patched = .false.            !! shares its change of volume with its neighbours
                                              !! where the material keeps its volume
      logical :: projectable = .false.        !! is `projected` where the material keeps its volume
      logical :: axisymmetric = .false.       !! also of the rigid RAX2
      integer :: layers(3) = 0                !! of a sheet along each parametric direction, which
                                              !! has more points then; 0: no sheet
      logical :: hourglass = .false.          !! its points do not see all motions: the others have
                                              !! the energy of module hourglass
      integer :: ndim = 0                     !! displacement components of a node, 2 or 3
      integer :: nnode = 0
      integer :: ndof = 0                     !! ndim*nnode; 0 if rigid
      integer :: nstress = 0                  !! 4 in 2D, 6 in 3D; 0 if rigid
      integer :: ngauss = 0
      integer :: nmode = 0                    !! internal modes; 0 unless enhanced
      real(wp), allocatable :: xi(:, :)             !! (ndim, ngauss) Gauss points
      real(wp), allocatable :: weight(:)            !! (ngauss) parametric weights
      real(wp), allocatable :: n(:, :)              !! (nnode, ngauss) shape functions
      real(wp), allocatable :: dn(:, :, :)          !! (ndim, nnode, ngauss) parametric slopes
      real(wp), allocatable :: extrapolation(:, :)  !! (nnode, ngauss) from Gauss points to nodes
      real(wp), allocatable :: whole_weight(:)      !! of a rule that has volumes and mean gradients
      real(wp), allocatable :: whole_dn(:, :, :)    !! of curved edges, if its own has not
      real(wp), allocatable :: whole_n(:, :)        !! shape functions there
      real(wp), allocatable :: n0(:), dn0(:, :)     !! (nnode), (ndim, nnode) centre, if enhanced
   end type element_type

contains

   !> The element of a deck word.
   subroutine new_element_type(self, word, formulation, found)
      type(element_type), intent(out) :: self
      character(len=*), intent(in) :: word          !! upper case, e.g. 'CAX4R', 'CPE4I/01'
      character(len=*), intent(in) :: formulation   !! '' or 'FULL': neither mean nor reduced
      logical, intent(out) :: found
      character(len=:), allocatable :: own
      integer :: last, d

      self%note = ''
      own = word
      last = index(word, '/')
      if (last > 0) then
         own = word(:last - 1)
         do d = last + 1, len(word)
            self%layers(d - last) = iachar(word(d:d)) - iachar('0')
         end do
      end if
      found = any(element_words == own)
      if (.not. found) return
      self%word = own
      if (own(1:1) == 'R') then
         call set_rigid(self)
         return
      end if
      if (own == 'CSS8') then
         own = 'C3D8I'
         self%layers(3) = 1
         self%note = 'CSS8 is C3D8I with six points through the thickness, from face S1 to S2'
      end if
      last = scan(own, '0123456789', back=.true.)
      call set_solid_cell(self, own(:3), own(4:last))
      call set_formulation(self, own(last + 1:), formulation)
      call tabulate(self)
   end subroutine new_element_type

   !> The cell of each word.
   subroutine cells_of_words(words, cell)
      character(len=*), intent(in) :: words(:)
      type(cell_type), allocatable, intent(out) :: cell(:)
      type(element_type) :: element
      logical :: found
      integer :: i

      allocate (cell(size(words)))
      do i = 1, size(cell)
         call new_element_type(element, trim(words(i)), '', found)
         cell(i) = element%cell
      end do
   end subroutine cells_of_words

   subroutine set_rigid(self)
      type(element_type), intent(inout) :: self
      logical :: found

      self%kind = element_kind%rigid
      self%formulation = element_formulation%full
      self%axisymmetric = self%word == 'RAX2'
      select case (self%word)
      case ('R3D3')
         call new_sided_cell(self%cell, 'triangle', found)
      case ('R3D4')
         call new_sided_cell(self%cell, 'quad', found)
      case default
         call new_sided_cell(self%cell, 'line2', found)
      end select
      self%ndim = self%cell%ndim + 1
      self%nnode = self%cell%nnode
   end subroutine set_rigid

   subroutine set_solid_cell(self, prefix, nodes)
      type(element_type), intent(inout) :: self
      character(len=*), intent(in) :: prefix, nodes
      character(len=*), parameter :: plane(4) = [character(len=9) :: 'triangle', 'quad', &
         & 'triangle6', 'quad8']
      character(len=*), parameter :: plane_nodes(4) = ['3', '4', '6', '8']
      character(len=*), parameter :: space(6) = [character(len=12) :: 'tetra', 'wedge', &
         & 'hexahedron', 'tetra10', 'wedge15', 'hexahedron20']
      character(len=*), parameter :: space_nodes(6) = [character(len=2) :: '4', '6', '8', '10', &
         & '15', '20']
      logical :: found

      if (prefix == 'C3D') then
         call new_cell(self%cell, trim(space(findloc(space_nodes, nodes, dim=1))), found)
      else
         call new_cell(self%cell, trim(plane(findloc(plane_nodes, nodes, dim=1))), found)
      end if
      select case (prefix)
      case ('CPE')
         self%kind = element_kind%plane_strain
      case ('CPS')
         self%kind = element_kind%plane_stress
      case ('CAX')
         self%kind = element_kind%axisymmetric
      case ('C3D')
         self%kind = element_kind%solid
      end select
      self%axisymmetric = self%kind == element_kind%axisymmetric
      self%ndim = self%cell%ndim
      self%nnode = self%cell%nnode
      self%ndof = self%ndim*self%nnode
      self%nstress = merge(6, 4, self%ndim == 3)
   end subroutine set_solid_cell

   subroutine set_formulation(self, letters, wish)
      type(element_type), intent(inout) :: self
      character(len=*), intent(in) :: letters   !! what follows the number of nodes
      character(len=*), intent(in) :: wish      !! '' or 'FULL'
      logical :: product, reduced, averaged
      character(len=:), allocatable :: name

      product = self%cell%name == 'quad' .or. self%cell%name == 'hexahedron'
      reduced = index(letters, 'R') > 0 .and. self%cell%quadratic
      averaged = product .and. self%kind /= element_kind%plane_stress
      name = trim(self%word)
      self%formulation = element_formulation%full
      if (index(letters, 'S') > 0) then
         self%formulation = element_formulation%centre
         self%hourglass = .true.
         return
      end if
      if (wish == 'FULL') then
         if (index(letters, 'R') > 0) self%note = &
            & name//' is integrated fully, as FORMULATION=FULL asks'
         return
      end if
      if (averaged) self%formulation = element_formulation%bbar
      self%patched = .not. (product .or. self%cell%quadratic) &
         & .and. self%kind /= element_kind%plane_stress
      self%projectable = self%kind /= element_kind%plane_stress .and. (self%cell%name == 'quad8' &
         & .or. self%cell%name == 'hexahedron20')
      ! More points through a sheet would lock it.
      if (reduced) self%projectable = self%projectable .and. any(self%layers > 0)
      if (reduced) self%formulation = element_formulation%reduced
      if (index(letters, 'R') > 0 .and. .not. reduced) then
         self%note = name//' is integrated fully'
         if (averaged) self%note = self%note//' with mean dilatation (B-bar)'
         self%note = self%note//', so it has no hourglass modes'
      else if (index(letters, 'I') > 0 .and. product) then
         self%formulation = element_formulation%enhanced
      else if (index(letters, 'I') > 0) then
         self%note = name//' is read without incompatible modes'
      else if (index(letters, 'M') > 0) then
         self%note = name//' is read as the standard quadratic element'
      end if
      if (index(letters, 'H') > 0) then
         if (len(self%note) > 0) self%note = self%note//'; '
         if (len(self%note) == 0) self%note = name//' is read as a displacement element: '
         self%note = self%note//'pressure is not an unknown, keep Poisson''s ratio below 0.5'
      end if
   end subroutine set_formulation

   subroutine tabulate(self)
      type(element_type), intent(inout) :: self
      type(rule_type) :: rule
      integer :: k

      call choose_rule(self, rule)
      self%ngauss = rule%npoint
      self%xi = rule%xi
      self%weight = rule%weight
      allocate (self%n(self%nnode, self%ngauss), self%dn(self%ndim, self%nnode, self%ngauss))
      do k = 1, self%ngauss
         call shape_functions(self%cell, self%xi(:, k), self%n(:, k), self%dn(:, :, k))
      end do
      call set_extrapolation(self)
      if (self%formulation == element_formulation%enhanced) call set_modes(self)
      call set_whole_rule(self)
   end subroutine tabulate

   !> A rule that has volumes and mean gradients to the last digit, where the element's own points
   !> are too few for it: then distorted meshes pass the patch test.
   !>
   !> Solids of second order: det J grad N has degree 3 in tetrahedra, 4 in triangles and 5 along
   !> the axis in wedges, 5 in bricks; 2 in bricks of eight nodes, for which 2 x 2 x 2 points do and
   !> fewer do not. Rings: r det J grad N has 4 in triangles and 5 in quadrilaterals. Quads in the
   !> plane need 1.
   subroutine set_whole_rule(self)
      type(element_type), intent(inout) :: self
      type(rule_type) :: rule
      integer :: k

      select case (self%cell%name)
      case ('tetra10')
         call new_rule(rule, self%cell%family, 3)
      case ('wedge15')
         call new_rule(rule, self%cell%family, 4, through=5)
      case ('hexahedron20')
         if (self%formulation /= element_formulation%reduced) return
         call new_rule(rule, self%cell%family, 5)
      case ('hexahedron')
         if (.not. self%hourglass) return
         call new_rule(rule, self%cell%family, 3)
      case ('triangle6')
         if (.not. self%axisymmetric) return
         call new_rule(rule, self%cell%family, 4)
      case ('quad8')
         if (.not. (self%axisymmetric .and. self%formulation == element_formulation%reduced)) return
         call new_rule(rule, self%cell%family, 5)
      case default
         return
      end select
      self%whole_weight = rule%weight
      allocate (self%whole_dn(self%ndim, self%nnode, rule%npoint))
      allocate (self%whole_n(self%nnode, rule%npoint))
      do k = 1, rule%npoint
         call shape_functions(self%cell, rule%xi(:, k), self%whole_n(:, k), self%whole_dn(:, :, k))
      end do
   end subroutine set_whole_rule

   subroutine set_modes(self)
      type(element_type), intent(inout) :: self
      real(wp) :: centre(self%ndim)

      self%nmode = self%ndim**2
      if (self%axisymmetric) self%nmode = self%nmode + 1
      if (self%ndim == 3) self%nmode = self%nmode + 3
      self%nmode = self%nmode + 2*count(self%layers == 1)
      centre = 0.0_wp
      allocate (self%n0(self%nnode), self%dn0(self%ndim, self%nnode))
      call shape_functions(self%cell, centre, self%n0, self%dn0)
   end subroutine set_modes

   !> Degrees that pass the patch test on straight-sided cells; one point more for the axisymmetric
   !> triangle.
   subroutine choose_rule(self, rule)
      type(element_type), intent(in) :: self
      type(rule_type), intent(out) :: rule
      integer :: degree

      if (any(self%layers > 0)) then
         degree = 3
         if (self%cell%quadratic .and. self%formulation /= element_formulation%reduced) degree = 5
         call new_layered_rule(rule, self%cell%family, degree, self%layers)
         return
      end if
      select case (self%cell%name)
      case ('triangle', 'tetra')
         degree = merge(2, 1, self%axisymmetric)
         call new_rule(rule, self%cell%family, degree)
      case ('triangle6', 'tetra10')
         call new_rule(rule, self%cell%family, 2)
      case ('wedge')
         call new_rule(rule, self%cell%family, 2, through=3)
      case ('wedge15')
         call new_rule(rule, self%cell%family, 2, through=5)
      case ('quad', 'hexahedron')
         call new_rule(rule, self%cell%family, merge(1, 3, &
            & self%formulation == element_formulation%centre))
      case default
         degree = merge(3, 5, self%formulation == element_formulation%reduced)
         call new_rule(rule, self%cell%family, degree)
      end select
   end subroutine choose_rule

   !> Least squares by the functions of the linear cell, evaluated at the nodes; where there are
   !> fewer points than corners, linear along the directions in which the points differ.
   subroutine set_extrapolation(self)
      type(element_type), intent(inout) :: self
      type(cell_type) :: linear
      real(wp) :: slopes(3, 8)
      real(wp), allocatable :: at_gauss(:, :), at_node(:, :), normal(:, :), fit(:, :)
      integer :: d, k, m

      allocate (self%extrapolation(self%nnode, self%ngauss))
      m = self%cell%ncorner
      if (self%ngauss < m) then
         self%extrapolation = 1.0_wp/real(self%ngauss, wp)
         do d = 1, self%ndim
            associate (middle => sum(self%xi(d, :))/real(self%ngauss, wp), &
               & node => self%cell%xi(d, :self%nnode))
               if (maxval(self%xi(d, :)) - minval(self%xi(d, :)) < 0.1_wp) cycle
               do k = 1, self%ngauss
                  self%extrapolation(:, k) = self%extrapolation(:, k) + (node - middle) &
                     & *(self%xi(d, k) - middle)/sum((self%xi(d, :) - middle)**2)
               end do
            end associate
         end do
         return
      end if
      call new_cell_of(linear, 2*self%cell%family - 1)
      allocate (at_gauss(m, self%ngauss), at_node(m, self%nnode))
      do k = 1, self%ngauss
         call shape_functions(linear, self%xi(:, k), at_gauss(:, k), slopes(:self%ndim, :m))
      end do
      do k = 1, self%nnode
         call shape_functions(linear, self%cell%xi(:self%ndim, k), at_node(:, k), &
            & slopes(:self%ndim, :m))
      end do
      normal = matmul(at_gauss, transpose(at_gauss))
      fit = at_gauss
      call solve_in_place(normal, fit)
      self%extrapolation = matmul(transpose(at_node), fit)
   end subroutine set_extrapolation

   !> Elimination without pivoting: a is symmetric positive definite, at most 8 x 8.
   pure subroutine solve_in_place(a, b)
      real(wp), intent(inout) :: a(:, :), b(:, :)
      integer :: i, k

      do k = 1, size(a, 1)
         b(k, :) = b(k, :)/a(k, k)
         a(k, :) = a(k, :)/a(k, k)
         do i = 1, size(a, 1)
            if (i == k) cycle
            b(i, :) = b(i, :) - a(i, k)*b(k, :)
            a(i, :) = a(i, :) - a(i, k)*a(k, :)
         end do
      end do
   end subroutine solve_in_place
end module lopin_element_type
