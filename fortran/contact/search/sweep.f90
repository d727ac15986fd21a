!> Continuous collision test: does a point pass through the opposite surface within an increment?
!>
!> At the ends of the increment nothing may show. A point that goes no farther than its gap, or than
!> half a facet, cannot pass. The others are looked at on the way: a gap is a distance, so a point
!> may go that far before it has to be asked again. What is seen deep behind the surface, or is not
!> seen in front of it again, has passed.
module lopin_sweep
   use lopin_kinds, only : wp
   implicit none
   private
   public :: sweep_type, new_sweep, next_share, take_gap, least_way, most_turn

   !> Facets that a point moves in any case, that it may go unasked, and of depth that are too much.
   real(wp), parameter :: least_way = 0.5_wp, unasked = 0.25_wp, deep = 0.5_wp, shallow = 0.01_wp
   !> Rotation between two looks [rad]; looks at an increment.
   real(wp), parameter :: most_turn = 0.1745_wp
   integer, parameter :: most_looks = 256

   type :: sweep_type
      integer :: n = 0
      integer, allocatable :: point(:)         !! (n) that may pass
      real(wp), allocatable :: way(:)          !! (n) of the increment [length]
      real(wp), allocatable :: size(:)         !! (n) facets [length]
      real(wp), allocatable :: level(:)        !! (n) gap or penetration that the ends allow
      real(wp), allocatable :: due(:)          !! (n) share of the increment of the next look
      logical, allocatable :: behind(:)        !! (n) the last look found it behind the surface
      real(wp) :: share = 0.0_wp               !! looked at now
      real(wp) :: most_share = 1.0_wp          !! between two looks
      integer :: passed = 0                    !! a point that has passed; 0: none
   end type sweep_type

contains

   !> The points of `way` longer than their gaps; `level` is the least gap at the two ends, <= 0.
   pure subroutine new_sweep(self, gap, way, size_, level, turn)
      type(sweep_type), intent(out) :: self
      real(wp), intent(in) :: gap(:)           !! (points) at the start; < 0: none known [length]
      real(wp), intent(in) :: way(:), size_(:), level(:)
      real(wp), intent(in) :: turn             !! largest rotation of a tool [rad]
      integer :: i

      self%point = pack([(i, i=1, size(way))], way > max(gap, least_way*size_))
      self%n = size(self%point)
      if (self%n == 0) return
      self%way = way(self%point)
      self%size = size_(self%point)
      self%level = level(self%point)
      self%due = max(gap(self%point), unasked*self%size)/self%way
      self%behind = [(.false., i=1, self%n)]
      self%most_share = 1.0_wp
      if (turn > most_turn) self%most_share = most_turn/turn
   end subroutine new_sweep

   !> The next share of the increment to look at, with the points that are due; .false. at the end.
   logical function next_share(self)
      type(sweep_type), intent(inout) :: self

      next_share = .false.
      if (self%n == 0 .or. self%passed > 0) return
      self%share = max(min(minval(self%due), self%share + self%most_share), &
         & self%share + 1.0_wp/most_looks)
      next_share = self%share < 1.0_wp
   end function next_share

   !> What a look at point k of the sweep found: its gap, if it faces the surface.
   pure subroutine take_gap(self, k, faces, gap)
      type(sweep_type), intent(inout) :: self
      integer, intent(in) :: k
      logical, intent(in) :: faces
      real(wp), intent(in) :: gap              !! [length]
      real(wp) :: free

      free = 0.0_wp
      if (faces) then
         free = gap
         self%behind(k) = gap < self%level(k) - shallow*self%size(k)
         if (gap < self%level(k) - deep*self%size(k)) self%passed = self%point(k)
      end if
      self%due(k) = self%share + max(free, unasked*self%size(k))/self%way(k)
   end subroutine take_gap
end module lopin_sweep
