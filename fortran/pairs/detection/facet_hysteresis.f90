!> Hysteresis of the facet that a point belongs to at a joint of facets, where neither facet alone
!> has an equilibrium.
!>
!> In a valley between two facets the normal jumps where the nearer facet changes. A point that is
!> pushed to that place from both sides has no equilibrium on the nearest facet: Newton passes it
!> from one to the other for ever. Such a point keeps one of them, continued a little past the
!> joint, until it is too far beyond it or too far from its nearest facet; then it may not have
!> that facet again in the increment. All other points belong to their nearest facet.
!>
!> What is kept is a trial; `kept_beyond` says what of it the increment leaves to the next.
module lopin_facet_hysteresis
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_surface, only : surface_type
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal
   use lopin_feature, only : projection_type, limits_type, settle
   implicit none
   private
   public :: facet_hysteresis_type, new_facet_hysteresis, start_facet_hysteresis, record_facet, &
      & kept_beyond, keep_facet
   public :: most_past, most_apart, most_returns

   !> How far past a joint a kept facet goes on, in facets; how much deeper or higher than on the
   !> nearest facet its foot may be, in facets.
   real(wp), parameter :: most_past = 0.25_wp, most_apart = 0.05_wp
   !> Returns to a place that was left in the increment, after which it is kept: Newton that gets
   !> home by itself seldom comes back so often, and 30 iterations without progress end it.
   integer, parameter :: most_returns = 6

   type :: facet_hysteresis_type
      integer, allocatable :: held(:)          !! (n) facet that a point keeps; 0: the nearest
      integer, allocatable :: last(:, :)       !! (2, n) facet and place of the last iteration
      integer, allocatable :: before(:, :)     !! (2, n) those it had before
      integer, allocatable :: returns(:)       !! (n) how often it came back there
      integer, allocatable :: refused(:)       !! (n) facet that was kept too long; 0: none
   end type facet_hysteresis_type

contains

   !> Points that have met no facet yet.
   subroutine new_facet_hysteresis(self, n)
      type(facet_hysteresis_type), intent(out) :: self
      integer, intent(in) :: n                 !! points

      allocate (self%held(n), self%returns(n), self%refused(n), source=0)
      allocate (self%last(2, n), self%before(2, n), source=0)
   end subroutine new_facet_hysteresis

   !> From the facets that the last accepted increment left.
   subroutine start_facet_hysteresis(self, accepted)
      type(facet_hysteresis_type), intent(inout) :: self
      integer, intent(in) :: accepted(:)       !! (n) of lopin_state

      self%held = accepted
      self%last = 0
      self%before = 0
      self%returns = 0
      self%refused = 0
   end subroutine start_facet_hysteresis

   !> Tell where a closed point lies in a new iteration.
   pure subroutine record_facet(self, i, found, kept)
      type(facet_hysteresis_type), intent(inout) :: self
      integer, intent(in) :: i
      type(projection_type), intent(in) :: found
      logical, intent(in) :: kept              !! the facet that it holds still carries it
      integer :: here(2)

      if (self%held(i) > 0) then
         if (kept) return
         self%refused(i) = self%held(i)
         self%held(i) = 0
         self%returns(i) = 0
      end if
      here = [found%facet, found%place]
      if (all(here == self%last(:, i))) return
      if (all(here == self%before(:, i))) self%returns(i) = self%returns(i) + 1
      self%before(:, i) = self%last(:, i)
      self%last(:, i) = here
      if (self%returns(i) < most_returns .or. .not. is_on_facet(found)) return
      if (found%facet /= self%refused(i)) self%held(i) = found%facet
   end subroutine record_facet

   !> A facet is kept beyond the increment only by a point that lies past its end.
   pure integer function kept_beyond(self, i, past) result(facet)
      type(facet_hysteresis_type), intent(in) :: self
      integer, intent(in) :: i
      logical, intent(in) :: past

      facet = merge(self%held(i), 0, past)
   end function kept_beyond

   !> The foot on the continued facet instead of that on the nearest one, if they are near enough.
   pure subroutine keep_facet(surface, facet, x, n_slave, limits, found, kept, past)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: x(:)             !! (ndim) [length]
      real(wp), intent(in) :: n_slave(:)       !! (ndim) outward unit normal; 0: any side
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(inout) :: found   !! in: on the nearest facet
      logical, intent(out) :: kept             !! the facet carries the point
      logical, intent(out) :: past             !! and the point lies past its end
      type(closest_type) :: closest
      type(projection_type) :: other
      real(wp) :: at(3), side(3), slack(4)
      integer :: cell, family

      past = .false.
      kept = found%facet == facet .and. is_on_facet(found)
      if (kept .or. found%facet == 0) return
      at = 0.0_wp
      at(:size(x)) = x
      side = 0.0_wp
      side(:size(x)) = n_slave
      cell = surface%facets%cell(facet)
      family = surface%basis%family(cell)
      slack = merge(1.0_wp, 2.0_wp, family == cell_family%triangle)*most_past
      call project_on_facet(surface%coefficient(:, :, facet), family, &
         & surface%basis%centre(:, cell), slack, at, closest)
      if (closest%place /= place%inside) return
      if (any(abs(n_slave) > 0.0_wp)) then
         if (dot_product(n_slave, head_on(surface, facet, closest%xi, size(x))) > limits%cosine) &
            & return
      end if
      call settle(surface, facet, closest, at, side, limits, other)
      if (other%facet == 0) return
      if (abs(other%gap - found%gap) > most_apart*surface%size(facet)) return
      kept = .true.
      past = .true.
      found = other
   end subroutine keep_facet

   !> The foot is free to move on its facet, or on the facet continued at the surface's perimeter.
   pure logical function is_on_facet(found)
      type(projection_type), intent(in) :: found
      is_on_facet = any(found%place == [place%inside, place%extended])
   end function is_on_facet

   !> Normal of a facet in the space of the slave's.
   pure function head_on(surface, facet, xi, ndim) result(n)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet, ndim
      real(wp), intent(in) :: xi(2)
      real(wp) :: n(ndim), normal(3)

      normal = facet_unit_normal(surface%coefficient(:, :, facet), &
         & surface%basis%family(surface%facets%cell(facet)), xi)
      n = normal(:ndim)
   end function head_on
end module lopin_facet_hysteresis
