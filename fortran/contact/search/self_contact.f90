!> A surface against itself: which facets a node cannot meet, and how deep it may enter.
!>
!> The facets around a node are its neighbours, never its contact. The other face of the wall that
!> it belongs to looks away from it, but from behind it seems to be entered by the whole thickness,
!> and so does the other flank of a hollow crest: half of what lies behind where an increment begins
!> bounds what counts as penetration, so that contact never goes through material. Flanks come
!> nearer and turn to each other as folds close: that is measured in every increment. A fold may be
!> closed: the face opposite is no wall, it is nearer than the own elements are deep, or than what
!> presses has entered. Facets that do not look at the node are left out by the side of the search.
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
   !> Points that press are looked for behind by this share of that depth; walls are deeper than so
   !> many times what they have entered.
   real(wp), parameter :: pressed_in = 0.5_wp, deeper = 2.0_wp
   !> Flanks that turn to each other within the increment, beside the bound of the search: cosine.
   real(wp), parameter :: turning = 0.15_wp

   type :: self_contact_type
      integer, allocatable :: first(:)        !! (n + 1) first neighbour of each point
      integer, allocatable :: neighbour(:)    !! facets that hold the point's node
      real(wp), allocatable :: own(:)         !! (n) depth of its shallowest element [length]
      real(wp), allocatable :: depth(:)       !! (n) deeper is no contact [length]
      real(wp), allocatable :: entered(:)     !! (n) of what presses, at the start [length]
   end type self_contact_type

contains

   !> Which facets are around each slave point, so that it cannot meet them.
   subroutine new_self_contact(self, surface, node, deep)
      type(self_contact_type), intent(out) :: self
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: node(:)          !! (n) mesh node of each slave point
      real(wp), intent(in) :: deep(:)         !! (facets) how far elements reach inward [length]
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
      allocate (self%first(size(node) + 1), self%own(size(node)))
      allocate (self%depth(size(node)), source=huge(1.0_wp))
      allocate (self%entered(size(node)), source=0.0_wp)
      self%first(1) = 1
      do i = 1, size(node)
         self%first(i + 1) = self%first(i) + count_of(node(i))
      end do
      allocate (self%neighbour(self%first(size(node) + 1) - 1))
      do i = 1, size(node)
         associate (around => holder(:count_of(node(i)), node(i)))
            self%neighbour(self%first(i):self%first(i + 1) - 1) = around
            self%own(i) = 0.0_wp
            if (size(around) > 0) self%own(i) = minval(deep(around))
         end associate
      end do
   end subroutine new_self_contact

   !> Half the way to the other face of the wall of each point; a fold may be closed.
   subroutine measure_thickness(self, surface, tree, x, n_slave, cosine, pressed)
      type(self_contact_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)         !! (ndim, n) [length]
      real(wp), intent(in) :: n_slave(:, :)   !! (ndim, n)
      real(wp), intent(in) :: cosine          !! of the search
      logical, intent(in) :: pressed(:)       !! (n) points that may have entered what is opposite
      type(limits_type) :: wall, contact
      type(projection_type) :: found
      integer :: i

      wall%cosine = cosine + turning
      wall%behind = .true.
      contact%cosine = cosine
      self%depth = huge(1.0_wp)
      self%entered = 0.0_wp
      do i = 1, size(x, 2)
         associate (around => self%neighbour(self%first(i):self%first(i + 1) - 1))
            wall%shallow = own_depth*self%own(i)
            if (pressed(i)) then
               contact%depth = pressed_in*self%own(i)
               call find_projection(surface, tree, x(:, i), n_slave(:, i), contact, found, around)
               if (found%facet > 0) self%entered(i) = max(0.0_wp, -found%gap)
               wall%shallow = max(wall%shallow, deeper*self%entered(i))
            end if
            call find_projection(surface, tree, x(:, i), n_slave(:, i), wall, found, around)
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
