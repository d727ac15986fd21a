!> A surface against itself: which facets a node cannot meet, and how deep it may enter.
!>
!> The facets around a node are its neighbours, never its contact. The other face of the wall that
!> it belongs to looks away from it, but from behind it seems to be entered by the whole thickness:
!> half the thickness at the start bounds what counts as penetration, so that contact never goes
!> through material. A surface may begin with its fold closed: the face opposite is no wall, it is
!> nearer than the own elements are deep. Facets that do not look at the node are left out by the
!> side of the search.
module lopin_self_contact
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, find_projection
   implicit none
   private
   public :: self_contact_type, new_self_contact, measure_thickness, depths_of_elements

   !> What is behind a point by less than this share of its elements' depth, where they are
   !> shallowest, is no wall of theirs: walls narrow to less only within one element.
   real(wp), parameter :: own_depth = 0.2_wp

   type :: self_contact_type
      integer, allocatable :: first(:)        !! (n + 1) first neighbour of each point
      integer, allocatable :: neighbour(:)    !! facets that hold the point's node
      real(wp), allocatable :: depth(:)       !! (n) deeper is no contact [length]
   end type self_contact_type

contains

   !> Which facets are around each slave point, so that it cannot meet them.
   subroutine new_self_contact(self, surface, node)
      type(self_contact_type), intent(out) :: self
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: node(:)          !! (n) mesh node of each slave point
      integer, allocatable :: holder(:, :), count_of(:)
      integer :: i, k, j, top

      top = maxval([0, node, surface%node])
      allocate (count_of(top), source=0)
      do i = 1, surface%facets%n
         associate (own => surface%facets%node(:surface%facets%nnode(i), i))
            count_of(own) = count_of(own) + 1
         end associate
      end do
      allocate (holder(maxval([0, count_of]), top))
      count_of = 0
      do i = 1, surface%facets%n
         do k = 1, surface%facets%nnode(i)
            j = surface%facets%node(k, i)
            count_of(j) = count_of(j) + 1
            holder(count_of(j), j) = i
         end do
      end do
      allocate (self%first(size(node) + 1), self%depth(size(node)))
      self%depth = huge(1.0_wp)
      self%first(1) = 1
      do i = 1, size(node)
         self%first(i + 1) = self%first(i) + count_of(node(i))
      end do
      allocate (self%neighbour(self%first(size(node) + 1) - 1))
      do i = 1, size(node)
         self%neighbour(self%first(i):self%first(i + 1) - 1) = holder(:count_of(node(i)), node(i))
      end do
   end subroutine new_self_contact

   !> Half the way to the other face of the wall of each point; a fold may be closed.
   subroutine measure_thickness(self, surface, tree, x, n_slave, deep, cosine)
      type(self_contact_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)         !! (ndim, n) [length]
      real(wp), intent(in) :: n_slave(:, :)   !! (ndim, n)
      real(wp), intent(in) :: deep(:)         !! (facets) how far elements reach inward [length]
      real(wp), intent(in) :: cosine          !! of the search
      type(limits_type) :: limits
      type(projection_type) :: found
      integer :: i

      limits%cosine = cosine
      limits%behind = .true.
      do i = 1, size(x, 2)
         associate (around => self%neighbour(self%first(i):self%first(i + 1) - 1))
            limits%shallow = own_depth*minval([huge(1.0_wp), deep(around)])
            if (size(around) == 0) limits%shallow = 0.0_wp
            call find_projection(surface, tree, x(:, i), n_slave(:, i), limits, found, around)
         end associate
         if (found%facet > 0) self%depth(i) = 0.5_wp*abs(found%gap)
      end do
   end subroutine measure_thickness

   !> How far the element behind each facet reaches inward from its middle, at least.
   function depths_of_elements(surface, x, conn) result(deep)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:, :)         !! (ndim, mesh nodes) [length]
      integer, intent(in) :: conn(:, :)       !! (corners, elements), zeros behind the last
      real(wp) :: deep(surface%facets%n)
      integer :: i, k, d

      d = surface%ndim
      deep = huge(1.0_wp)
      do i = 1, surface%facets%n
         associate (own => conn(:, surface%facets%element(i)), disc => surface%disc(:, i), &
            & node => surface%facets%node(:surface%facets%nnode(i), i))
            do k = 1, count(own > 0)
               if (any(node == own(k))) cycle
               deep(i) = min(deep(i), dot_product(disc(:d) - x(:, own(k)), disc(4:3 + d)))
            end do
         end associate
         if (.not. deep(i) < huge(1.0_wp)) deep(i) = 0.0_wp
      end do
      deep = max(deep, 0.0_wp)
   end function depths_of_elements
end module lopin_self_contact
