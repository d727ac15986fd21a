!> The overlap of a slave facet and a master facet: integrals of the standard basis.
module lopin_mortar_overlap
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: overlap_type, overlap_list_type, least_type, add_overlap, meet_point, cosine_between
   public :: overlap_limits_type, area_measure_type

   !> Where the gap of an overlap is least.
   type :: least_type
      real(wp) :: gap = huge(1.0_wp)       !! along the master's normal, >= 0 open [length]
      real(wp) :: n(8) = 0.0_wp            !! functions of the slave facet there
      real(wp) :: m(8) = 0.0_wp            !! of the master facet
   end type least_type

   !> Weight of all integrals: thickness, or 2 pi r, or 1 in space.
   type :: overlap_type
      integer :: slave = 0, master = 0     !! facets
      real(wp) :: me(8, 8) = 0.0_wp        !! integral of N_j N_k over what both cover [area]
      real(wp) :: d(8) = 0.0_wp            !! integral of N_j [area]
      real(wp) :: b(8, 8) = 0.0_wp         !! integral of N_j N_l of the master [area]
      real(wp) :: gap(8) = 0.0_wp          !! integral of N_j gap, >= 0 open [area length]
      real(wp) :: area = 0.0_wp            !! [area]
      real(wp) :: part = 0.0_wp            !! of the slave facet [-]
      type(least_type) :: least
   end type overlap_type

   !> Which masters count as opposite a slave facet.
   type :: overlap_limits_type
      real(wp) :: reach = huge(1.0_wp)         !! along the slave's normals [length]
      real(wp) :: facing = 0.0_wp              !! n_slave.n_master must be below this [-]
      real(wp), allocatable :: depth(:)        !! (slave facets) deeper is no contact [length]
   end type overlap_limits_type

   !> What an area is measured by.
   type :: area_measure_type
      logical :: axisymmetric = .false.        !! 2 pi r in the place of the thickness
      real(wp), allocatable :: thickness(:)    !! (slave facets) ones unless plane [length]
   end type area_measure_type

   !> Overlaps in the order of their slave facets.
   type :: overlap_list_type
      integer :: n = 0
      integer :: lost = 0     !! a slave facet with points that found no place opposite; 0: none
      type(overlap_type), allocatable :: item(:)
   end type overlap_list_type

contains

   !> Of the axes of two facets, where the increment began if the surfaces move: which facets face
   !> each other stays within an increment, for a wall that comes and goes as a whole when it is
   !> seen at an angle makes the rows jump between Newton's iterations.
   pure real(wp) function cosine_between(slave, i, master, j) result(cosine)
      type(surface_type), intent(in) :: slave, master
      integer, intent(in) :: i, j

      if (allocated(slave%outlook) .and. allocated(master%outlook)) then
         cosine = dot_product(slave%outlook(:, i), master%outlook(:, j))
      else
         cosine = dot_product(slave%disc(4:6, i), master%disc(4:6, j))
      end if
   end function cosine_between

   !> One more point of an overlap.
   pure subroutine meet_point(self, gap, n, m)
      type(least_type), intent(inout) :: self
      real(wp), intent(in) :: gap              !! [length]
      real(wp), intent(in) :: n(:), m(:)       !! functions of the two facets there

      if (.not. gap < self%gap) return
      self%gap = gap
      self%n(:size(n)) = n
      self%m(:size(m)) = m
   end subroutine meet_point

   !> Append an overlap; the list grows as it must.
   pure subroutine add_overlap(self, item)
      type(overlap_list_type), intent(inout) :: self
      type(overlap_type), intent(in) :: item
      type(overlap_type), allocatable :: longer(:)

      if (.not. allocated(self%item)) allocate (self%item(64))
      if (self%n == size(self%item)) then
         allocate (longer(2*self%n))
         longer(:self%n) = self%item
         call move_alloc(longer, self%item)
      end if
      self%n = self%n + 1
      self%item(self%n) = item
   end subroutine add_overlap
end module lopin_mortar_overlap
