!> The neighbourhood of a slave node in the plane: what its mortar row depends on.
module lopin_mortar_patch_2d
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_list_type
   implicit none
   private
   public :: patch_type, met_row_type, basis_functions_type, new_patch, most_facets

   integer, parameter :: most_facets = 8

   !> A row by values: gap vector = sum coefficient*x / weight.
   type :: met_row_type
      real(wp) :: weight = 0.0_wp                  !! D [area]
      real(wp) :: normal(2) = 0.0_wp               !! out of the master: its mean opposite
      real(wp) :: gap = 0.0_wp                     !! mean by the dual function [length]
      real(wp), allocatable :: coefficient(:)      !! of each place; their sum is 0 [area]
   end type met_row_type

   !> What is around a slave node; places are numbers in `node`.
   type :: patch_type
      integer, allocatable :: node(:)              !! mesh node of each place; the first: the node
      integer :: nchain = 0                        !! slave facets: at the node, then beside those
      integer :: nnode(most_facets) = 0
      integer :: chain(3, most_facets) = 0
      logical :: at_node(most_facets) = .false.    !! integrated; others only have the normals
      integer :: piece(most_facets) = 1            !! smooth pieces: lopin_slave_pieces
      real(wp) :: middle(most_facets) = 0.0_wp     !! middle_share of the transformed basis
      integer, allocatable :: function(:)          !! places whose functions the row has
      integer, allocatable :: on(:)                !! the piece each of them is integrated on
      real(wp), allocatable :: share(:)            !! of each; the first: 1
      integer :: ncover = 0                        !! pairs of a slave facet and a master facet
      integer, allocatable :: over(:)              !! the slave facet, in the chain
      integer, allocatable :: ncovered(:)          !! nodes of the master facet
      integer, allocatable :: cover(:, :)          !! (3, ncover) places of them
      real(wp) :: lift = 0.0_wp                    !! of its gap above the mean [length]
      type(met_row_type) :: met                    !! its row where it was met last
   end type patch_type

   !> The dual functions that a row is integrated with: those of its node, then of the nodes that
   !> it takes over.
   type :: basis_functions_type
      integer, allocatable :: node(:)              !! mesh nodes, its own first
      real(wp), allocatable :: share(:)            !! of each; the first: 1
      integer, allocatable :: piece(:)             !! of lopin_slave_pieces, on which each is
   end type basis_functions_type

contains

   !> The neighbourhood of a slave node; the overlaps are those found on the present shape.
   subroutine new_patch(self, slave, master, list, functions, piece, middle)
      type(patch_type), intent(out) :: self
      type(surface_type), intent(in) :: slave, master
      type(overlap_list_type), intent(in) :: list
      type(basis_functions_type), intent(in) :: functions
      integer, intent(in), optional :: piece(:)    !! (slave facets) of lopin_slave_pieces
      real(wp), intent(in), optional :: middle(:)  !! (slave facets) middle_share; 0
      integer :: facet(most_facets)
      integer, allocatable :: near(:), around(:)
      integer :: i, k, m, pass, own

      self%node = functions%node
      self%function = [(k, k=1, size(functions%node))]
      self%share = functions%share
      self%on = functions%piece
      near = self%node
      do pass = 1, 2
         around = facets_around(slave, near)
         do m = 1, size(around)
            i = around(m)
            if (self%nchain == most_facets) exit
            if (any(facet(:self%nchain) == i)) cycle
            own = 1
            if (present(piece)) own = piece(i)
            associate (nodes => slave%facets%node(:slave%facets%nnode(i), i))
               if (pass == 1) then
                  if (.not. any([(any(nodes == near(k) .and. self%on(k) == own), &
                     & k=1, size(self%on))])) cycle
               end if
               call add_chain(self, nodes, pass == 1, own)
            end associate
            facet(self%nchain) = i
            if (present(middle)) self%middle(self%nchain) = middle(i)
         end do
         if (pass == 2) exit
         near = self%node
         call add_covers(self, master, list, facet(:self%nchain))
      end do
   end subroutine new_patch

   !> Facets that have one of some nodes, in their order.
   pure function facets_around(slave, near) result(around)
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: near(:)               !! of the mesh
      integer, allocatable :: around(:)
      integer :: i, k, m

      allocate (around(0))
      do k = 1, size(near)
         i = findloc(slave%node, near(k), 1)
         ! Where pieces meet a node stands in the list once for each of them.
         do while (i > 0 .and. i <= slave%nnode)
            if (slave%node(i) /= near(k)) exit
            do m = slave%ring_first(i), slave%ring_first(i + 1) - 1
               call take(slave%ring(m))
            end do
            ! Rings are of corners; the middle of a facet is of that alone.
            if (slave%ring_first(i + 1) == slave%ring_first(i)) &
               & call take(findloc(slave%local(3, :), i, 1))
            i = i + 1
         end do
      end do

   contains

      pure subroutine take(facet)
         integer, intent(in) :: facet
         integer :: before

         if (facet == 0 .or. any(around == facet)) return
         before = count(around < facet)
         around = [around(:before), facet, around(before + 1:)]
      end subroutine take
   end function facets_around

   subroutine add_chain(self, nodes, at_node, piece)
      type(patch_type), intent(inout) :: self
      integer, intent(in) :: nodes(:)
      logical, intent(in) :: at_node
      integer, intent(in) :: piece
      integer :: k

      self%nchain = self%nchain + 1
      self%nnode(self%nchain) = size(nodes)
      self%at_node(self%nchain) = at_node
      self%piece(self%nchain) = piece
      do k = 1, size(nodes)
         call take_place(self, nodes(k), self%chain(k, self%nchain))
      end do
   end subroutine add_chain

   subroutine add_covers(self, master, list, facet)
      type(patch_type), intent(inout) :: self
      type(surface_type), intent(in) :: master
      type(overlap_list_type), intent(in) :: list
      integer, intent(in) :: facet(:)
      integer :: i, k, m

      allocate (self%over(0), self%ncovered(0), self%cover(3, 0))
      do m = 1, size(facet)
         do i = first_of(list, facet(m)), list%n
            if (list%item(i)%slave /= facet(m)) exit
            associate (opposite => list%item(i)%master)
               self%ncover = self%ncover + 1
               self%over = [self%over, m]
               self%ncovered = [self%ncovered, master%facets%nnode(opposite)]
               self%cover = reshape([self%cover, 0, 0, 0], [3, self%ncover])
               do k = 1, master%facets%nnode(opposite)
                  call take_place(self, master%facets%node(k, opposite), &
                     & self%cover(k, self%ncover))
               end do
            end associate
         end do
      end do
   end subroutine add_covers

   !> Overlaps stand in the order of their slave facets: the first of one.
   pure integer function first_of(list, facet) result(first)
      type(overlap_list_type), intent(in) :: list
      integer, intent(in) :: facet
      integer :: last, middle

      first = 1
      last = list%n + 1
      do while (first < last)
         middle = (first + last)/2
         if (list%item(middle)%slave < facet) then
            first = middle + 1
         else
            last = middle
         end if
      end do
   end function first_of

   subroutine take_place(self, node, place)
      type(patch_type), intent(inout) :: self
      integer, intent(in) :: node
      integer, intent(out) :: place

      place = findloc(self%node, node, 1)
      if (place > 0) return
      self%node = [self%node, node]
      place = size(self%node)
   end subroutine take_place
end module lopin_mortar_patch_2d
