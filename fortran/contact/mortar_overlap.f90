!> What a slave facet and a master facet share: integrals of the standard basis, from the kernels.
module lopin_mortar_overlap
   use lopin_kinds, only : wp
   implicit none
   private
   public :: overlap_type, overlap_list_type, add_overlap

   !> Weight of all integrals: thickness, or 2 pi r, or 1 in space.
   type :: overlap_type
      integer :: slave = 0, master = 0     !! facets
      real(wp) :: me(8, 8) = 0.0_wp        !! integral of N_j N_k over what both cover [area]
      real(wp) :: d(8) = 0.0_wp            !! integral of N_j [area]
      real(wp) :: b(8, 8) = 0.0_wp         !! integral of N_j N_l of the master [area]
      real(wp) :: gap(8) = 0.0_wp          !! integral of N_j gap, >= 0 open [area length]
      real(wp) :: area = 0.0_wp            !! [area]
   end type overlap_type

   !> Overlaps in the order of their slave facets.
   type :: overlap_list_type
      integer :: n = 0
      type(overlap_type), allocatable :: item(:)
   end type overlap_list_type

contains

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
