!> Gaps on the way of an increment in which points go far beside their masters: slip counts from
!> where each of them is met first.
module lopin_touch_path
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_sweep, only : least_way, most_turn
   use lopin_master_surfaces, only : move_masters
   use lopin_closest_feature, only : opposite_type, find_opposite
   use lopin_gap_path, only : gap_path_type, unseen
   use lopin_touch_onset, only : may_touch
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_nonlinear_sweep, only : measure_ways, gap_of
   implicit none
   private
   public :: find_gap_path

   !> Facets that a point moves between two looks, and looks at an increment.
   real(wp), parameter :: stride = 0.25_wp
   integer, parameter :: most_looks = 128

contains

   !> Look at the points that may touch on the way to u, which stands the noted share of it.
   subroutine find_gap_path(self, model, u, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      type(error_type), allocatable, intent(out) :: error
      type(opposite_type) :: opposite
      integer, allocatable :: point(:)
      real(wp) :: way(self%n), turn
      logical :: far(self%n)
      integer :: i, k, m

      self%path = gap_path_type()
      do i = 1, self%n
         far(i) = may_touch(self, i)
      end do
      if (.not. any(far)) return
      call measure_ways(self, model, self%start_u, u, way, turn)
      way = way/self%noted
      far = far .and. way > max(self%start_gap, least_way*self%size)
      if (.not. any(far)) return
      point = pack([(i, i=1, self%n)], far)
      associate (path => self%path)
         path%n = min(most_looks, ceiling(max(maxval(way(point)/(stride*self%size(point))), &
            & turn/self%noted/most_turn)))
         allocate (path%column(self%n), source=0)
         allocate (path%gap(0:path%n, size(point)))
         path%column(point) = [(k, k=1, size(point))]
         do m = 0, path%n
            call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, &
               & self%start_u + real(m, wp)/(real(path%n, wp)*self%noted)*(u - self%start_u), &
               & .false., self%cost, error)
            if (allocated(error)) return
            do k = 1, size(point)
               call find_opposite(opposite, self%masters, model, self%nonlinear_points_type, &
                  & point(k), self%cost)
               path%gap(m, k) = unseen
               if (opposite%facet > 0) path%gap(m, k) = gap_of(self, model, point(k), opposite)
            end do
         end do
      end associate
   end subroutine find_gap_path
end module lopin_touch_path
