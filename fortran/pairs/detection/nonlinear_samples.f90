!> The other places that the row of a mid-side node samples on a tool, on the present shape.
module lopin_nonlinear_samples
   use lopin_kinds, only : wp
   use lopin_row_samples, only : basis_of, one_patch
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_closest_feature, only : opposite_type, sample_foot_type
   use lopin_master_surfaces, only : masters_type
   implicit none
   private
   public :: find_sample_feet, row_value, offset_of

contains

   !> Feet of the ends of the edge, as the points there found them; on another patch than the
   !> middle, or on none, its patch is continued.
   pure subroutine find_sample_feet(opposite, points, i)
      type(opposite_type), intent(inout) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      type(sample_foot_type) :: sample(2)
      real(wp) :: c(2)
      integer :: k, other

      if (.not. points%share(i) > 0.0_wp) return
      c = basis_of(points%share(i))
      do k = 1, 2
         sample(k)%c = c(2)
         sample(k)%node = points%node(points%corner(k, i))
         other = met_alike(opposite, points, i, points%corner(k, i))
         sample(k)%continued = other == 0
         if (other > 0) sample(k)%foot = opposite(other)%foot
      end do
      opposite(i)%sample = sample
   end subroutine find_sample_feet

   !> The point of a node that meets the same patch as point i, from the node's first; 0: none.
   pure integer function met_alike(opposite, points, i, first) result(other)
      type(opposite_type), intent(in) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i, first
      real(wp) :: cosine, best
      integer :: k

      other = 0
      best = one_patch
      k = first
      do while (k <= points%n)
         if (points%node(k) /= points%node(first) .or. points%pair(k) /= points%pair(i)) exit
         cosine = dot_product(opposite(k)%foot%normal, opposite(i)%foot%normal)
         if (opposite(k)%facet > 0 .and. cosine >= best) then
            other = k
            best = cosine
         end if
         k = k + 1
      end do
   end function met_alike

   !> What the row of a point makes of values at points.
   pure real(wp) function row_value(points, i, value)
      class(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: value(:)         !! (npoint)
      real(wp) :: c(2)

      row_value = value(i)
      if (.not. points%share(i) > 0.0_wp) return
      c = basis_of(points%share(i))
      row_value = c(1)*value(i) + c(2)*sum(value(points%corner(:, i)))
   end function row_value

   !> Mean place of the samples of a row less its point's, in the frame of the tool.
   pure function offset_of(masters, points, i) result(offset)
      type(masters_type), intent(in) :: masters
      class(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp) :: offset(3), c(2), way(size(masters%x, 1))
      integer :: k

      offset = 0.0_wp
      if (.not. points%share(i) > 0.0_wp) return
      c = basis_of(points%share(i))
      way = 0.0_wp
      do k = 1, 2
         way = way + c(2)*(masters%x(:, points%node(points%corner(k, i))) &
            & - masters%x(:, points%node(i)))
      end do
      associate (turn => masters%of(points%pair(i))%motion%rotation, d => size(way))
         offset(:d) = matmul(transpose(turn(:d, :d)), way)
      end associate
   end function offset_of
end module lopin_nonlinear_samples
