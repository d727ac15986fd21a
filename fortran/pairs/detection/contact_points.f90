!> Slave points of all pairs: area, opposite feature, normal and gap of each.
!>
!> A point in a concave corner of a tool has two entries, one a wall.
module lopin_contact_points
   use lopin_kinds, only : wp
   use lopin_slave_points, only : slave_type
   use lopin_model, only : model_type, pair_type, overclosure_of
   implicit none
   private
   public :: contact_points_type, face_type, inner_type, sample_type, own_sample
   public :: no_contact_points, reserve, add_point, pair_is_tied, gaps_as_meshed, facing
   public :: is_eliminated, is_released

   !> One place of a row: of a node, or between the nodes of a facet.
   type :: sample_type
      real(wp) :: c = 1.0_wp              !! its part of the row
      integer :: point = 0                !! the contact point there
      integer :: nnode = 1
      integer :: node(8) = 0
      real(wp) :: shape(8) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      real(wp) :: normal(3) = 0.0_wp      !! out of the master, as the gap grows
      real(wp) :: foot(3) = 0.0_wp        !! [length]
      real(wp) :: gap = 0.0_wp            !! geometric [length]
   end type sample_type

   !> A facet of a slave whose tool has creases.
   type :: face_type
      integer :: pair = 0, cell = 0, nnode = 0
      integer :: node(8) = 0
      integer :: point(8) = 0             !! first points of its nodes
      real(wp) :: share = 0.0_wp          !! of mid-side functions that each corner gets
      real(wp) :: thickness = 1.0_wp      !! [length]
      logical :: curved = .false.         !! stands for a curve, lopin_curved_slave
      integer :: beside(2) = 0            !! nodes that the curve goes on to; 0: straight on
   end type face_type

   !> Places of the row of a point that meets a crease within its facets.
   type :: inner_type
      type(sample_type), allocatable :: sample(:)   !! those of a row without them first
   end type inner_type

   !> The slave points of all pairs of the linear paths. Many components: arrays by point, kept as
   !> arrays because search and rows go through one of them at a time.
   type :: contact_points_type
      integer :: n = 0
      integer, allocatable :: first(:)        !! (npair+1) first point of each pair
      integer, allocatable :: pair(:)         !! (n)
      integer, allocatable :: node(:)         !! (n) slave node
      integer, allocatable :: facet(:)   !! (n) facet of the master surface or segment of the tool;
                                         !! 0: none
      integer, allocatable :: master(:, :)   !! (>= 8, n) nodes opposite, zeros behind the last;
                                             !! none for a tool; may hold slave nodes: lopin_mortar
      real(wp), allocatable :: shape(:, :)    !! (the same) their shares; sum 1
      real(wp), allocatable :: xi(:, :)       !! (2, n)
      real(wp), allocatable :: normal(:, :)   !! (3, n) out of the master
      real(wp), allocatable :: side(:, :)     !! (3, n) slave's own outward normal; 0: unknown
      real(wp), allocatable :: foot(:, :)     !! (3, n) [length]
      real(wp), allocatable :: gap(:)         !! (n) geometric [length]
      real(wp), allocatable :: above(:)       !! (n) >= 0: no gap that the mean of a row weighs is
                                              !! as small, by this [length]
      real(wp), allocatable :: weight(:)      !! (n) [length^2]
      real(wp), allocatable :: size(:)        !! (n) of the slave's facets there [length]
      real(wp), allocatable :: depth(:)   !! (n) deeper is no contact, lopin_wall_depth [length]
      integer, allocatable :: corner(:, :)    !! (2, n) mid-side node of a transformed basis: first
                                              !! points of the ends of its edge; else 0
      real(wp), allocatable :: share(:)       !! (n) of its function that each end gets; else 0
      type(face_type), allocatable :: face(:)     !! of pairs with creased tools
      type(inner_type), allocatable :: inner(:)   !! (n) see lopin_face_rows
      integer, allocatable :: start_facet(:)      !! (n) as found at the start, for tools that move
      real(wp), allocatable :: start_foot(:, :), start_normal(:, :)   !! (3, n)
      integer, allocatable :: released(:)     !! (n) directions in which a tie does not hold the
                                              !! node, lopin_tie_release; unallocated: no ties
      real(wp), allocatable :: axes(:, :, :)  !! (3, 3, n) those first, then the rest
      logical, allocatable :: eliminated(:)   !! (n) tied nodes that are no unknowns,
                                              !! lopin_eliminated_ties; unallocated: none
      integer, allocatable :: tool(:)         !! (npair) 0: the master is a mesh
      integer, allocatable :: body(:)         !! (npair) rigid body that moves the tool; 0: fixed
   end type contact_points_type

   !> n_slave.n_master must be below this for the two to face each other.
   real(wp), parameter :: facing = -0.2_wp

contains

   !> None yet, and room for some.
   subroutine no_contact_points(self, npair)
      type(contact_points_type), intent(out) :: self
      integer, intent(in) :: npair

      allocate (self%first(npair + 1), source=1)
      allocate (self%tool(npair), self%body(npair), source=0)
      call reserve(self, 64, 8)
   end subroutine no_contact_points

   !> Room for more points or longer lists of masters; the old ones stay.
   subroutine reserve(self, capacity, masters)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: capacity, masters

      call grow_integers(self%pair, capacity)
      call grow_integers(self%node, capacity)
      call grow_integers(self%facet, capacity)
      call grow_table(self%master, masters, capacity)
      call grow_columns(self%shape, masters, capacity)
      call grow_columns(self%xi, 2, capacity)
      call grow_columns(self%normal, 3, capacity)
      call grow_columns(self%side, 3, capacity)
      call grow_columns(self%foot, 3, capacity)
      call grow_reals(self%gap, capacity)
      call grow_reals(self%above, capacity)
      call grow_reals(self%weight, capacity)
      call grow_reals(self%size, capacity)
      call grow_reals(self%depth, capacity)
      call grow_table(self%corner, 2, capacity)
      call grow_reals(self%share, capacity)
   end subroutine reserve

   subroutine grow_integers(array, capacity)
      integer, allocatable, intent(inout) :: array(:)
      integer, intent(in) :: capacity
      integer, allocatable :: longer(:)

      allocate (longer(capacity), source=0)
      if (allocated(array)) longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine grow_integers

   subroutine grow_table(array, rows, capacity)
      integer, allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: rows, capacity
      integer, allocatable :: longer(:, :)

      allocate (longer(rows, capacity), source=0)
      if (allocated(array)) longer(:size(array, 1), :size(array, 2)) = array
      call move_alloc(longer, array)
   end subroutine grow_table

   subroutine grow_reals(array, capacity)
      real(wp), allocatable, intent(inout) :: array(:)
      integer, intent(in) :: capacity
      real(wp), allocatable :: longer(:)

      allocate (longer(capacity), source=0.0_wp)
      if (allocated(array)) longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine grow_reals

   subroutine grow_columns(array, rows, capacity)
      real(wp), allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: rows, capacity
      real(wp), allocatable :: longer(:, :)

      allocate (longer(rows, capacity), source=0.0_wp)
      if (allocated(array)) longer(:size(array, 1), :size(array, 2)) = array
      call move_alloc(longer, array)
   end subroutine grow_columns

   !> One more point: node i of a slave, opposite to nothing yet.
   subroutine add_point(self, pair, slave, i)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: pair, i
      type(slave_type), intent(in) :: slave

      if (self%n == size(self%pair)) call reserve(self, 2*self%n, size(self%master, 1))
      self%n = self%n + 1
      self%pair(self%n) = pair
      self%node(self%n) = slave%node(i)
      self%weight(self%n) = slave%weight(i)
      self%size(self%n) = slave%size(i)
      self%depth(self%n) = huge(1.0_wp)
      self%side(:, self%n) = slave%normal(:, i)
   end subroutine add_point

   !> The node of a point as the only place of its row.
   pure type(sample_type) function own_sample(self, i) result(sample)
      type(contact_points_type), intent(in) :: self
      integer, intent(in) :: i

      sample%point = i
      sample%node(1) = self%node(i)
      sample%normal = self%normal(:, i)
      sample%foot = self%foot(:, i)
      sample%gap = self%gap(i)
   end function own_sample

   !> A tie determines the node of a point by those opposite.
   pure logical function is_eliminated(points, i)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i

      is_eliminated = .false.
      if (allocated(points%eliminated)) is_eliminated = points%eliminated(i)
   end function is_eliminated

   !> Supports of both sides hold the node of a tied point along an axis, so that its tie does not.
   pure logical function is_released(points, i, axis)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i, axis
      real(wp), parameter :: along = 1.0_wp - 1.0e-12_wp

      is_released = .false.
      if (allocated(points%released)) is_released = sum(points%axes(axis, &
         & :points%released(i), i)**2) > along
   end function is_released

   !> The pair glues: all directions, both ways.
   pure logical function pair_is_tied(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      pair_is_tied = pair%tied &
         & .or. model%interaction(pair%interaction)%overclosure == overclosure_of%tied
   end function pair_is_tied

   !> The gaps of a pair are those of its meshes, but where ADJUST moves nodes: it is not tied, and
   !> no *CLEARANCE stands for its geometry.
   pure logical function gaps_as_meshed(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      gaps_as_meshed = .not. (pair_is_tied(model, pair) .or. pair%has_clearance)
   end function gaps_as_meshed
end module lopin_contact_points
