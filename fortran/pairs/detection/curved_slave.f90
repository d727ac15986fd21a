!> Facets of a slave that stand for a curve, opposite curved profiles of tools.
!>
!> A sheet that is wrapped over a radius is a chain of chords. The point that presses leaps from
!> node to node, though the sheet rolls on its tool. Each facet is a cubic here, through its nodes
!> with the slopes of the parabolas through three of them (Bessel), so that places are linear in
!> those of four nodes and curves of second order are met exactly; at the ends of the surface and at
!> its edges a curve runs on straight. Row j has the soft least gap over its facets,
!>
!>    -s log( sum over points q of N_j(q) A_q exp(-gap(q)/s) / sum of N_j(q) A_q ),
!>
!> whose slopes are the shares by which the points bear: all of them where the sheet lies on its
!> tool, those about the least gap where it rolls.
module lopin_curved_slave
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, new_cell_of
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_smooth_facet, only : feature_cosine
   use lopin_face_points, only : face_points_type
   use lopin_contact_points, only : face_type
   implicit none
   private
   public :: curves_slave, join_facets, curve_points, soft_length

   !> The length s beside a facet: .4 of the sag of a facet on a radius of five facets.
   real(wp), parameter :: soft_length = 0.01_wp

contains

   !> The deck asks for it, and the tool is a profile in its plane.
   pure logical function curves_slave(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      curves_slave = pair%smooth .and. .not. pair%surface_to_surface .and. model%mesh%ndim == 2 &
         & .and. model%surface(pair%master)%kind == surface_of%tool
   end function curves_slave

   !> Linear facets of a pair that are to be curved, and the nodes that their curves go on to.
   subroutine join_facets(face, model, pair)
      type(face_type), intent(inout) :: face(:)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(cell_type) :: cell
      integer :: ending(model%mesh%nnode)      !! the facet that ends at a node; 0: none
      integer :: i, before

      ending = 0
      do i = 1, size(face)
         if (face(i)%pair /= pair) cycle
         call new_cell_of(cell, face(i)%cell)
         face(i)%curved = .not. cell%quadratic
         if (face(i)%curved) ending(face(i)%node(2)) = i
      end do
      do i = 1, size(face)
         if (face(i)%pair /= pair .or. .not. face(i)%curved) cycle
         before = ending(face(i)%node(1))
         if (before == 0) cycle
         if (.not. dot_product(way(before), way(i)) > feature_cosine) cycle
         face(i)%beside(1) = face(before)%node(1)
         face(before)%beside(2) = face(i)%node(2)
      end do

   contains

      function way(i)
         integer, intent(in) :: i
         real(wp) :: way(2)

         way = model%mesh%x(:, face(i)%node(2)) - model%mesh%x(:, face(i)%node(1))
         way = way/norm2(way)
      end function way
   end subroutine join_facets

   !> The points of a facet on its curve, and their parts in the rows of its two nodes; the nodes of
   !> the curve are those of the facet and the next ones on both sides, or these again.
   pure subroutine curve_points(inside, face, start, x, curve)
      type(face_points_type), intent(inout) :: inside
      type(face_type), intent(in) :: face
      real(wp), intent(in) :: start(:, :)      !! (2, nnode) at the start [length]
      real(wp), intent(in) :: x(:, :)          !! (2, nnode) now [length]
      type(face_type), intent(out) :: curve    !! of four nodes
      real(wp) :: line(2, inside%n), slope(4, 2), h, s
      integer :: q

      curve = face
      curve%nnode = 4
      curve%node(3:4) = merge(face%beside, face%node(:2), face%beside > 0)
      line = inside%shape(:2, :)
      associate (n => curve%node)
         h = norm2(start(:, n(2)) - start(:, n(1)))
         slope = 0.0_wp
         slope(1:2, 1) = [-1.0_wp, 1.0_wp]
         slope(1:2, 2) = [-1.0_wp, 1.0_wp]
         if (face%beside(1) > 0) slope([1, 2, 3], 1) = bend(h, norm2(start(:, n(1)) &
            & - start(:, n(3))))
         if (face%beside(2) > 0) slope([2, 1, 4], 2) = -bend(h, norm2(start(:, n(4)) &
            & - start(:, n(2))))
      end associate
      deallocate (inside%shape)
      allocate (inside%shape(4, inside%n), source=0.0_wp)
      do q = 1, inside%n
         s = line(2, q)
         inside%shape(1, q) = (1.0_wp - s)**2*(1.0_wp + 2.0_wp*s)
         inside%shape(2, q) = s**2*(3.0_wp - 2.0_wp*s)
         inside%shape(:, q) = inside%shape(:, q) + s*(1.0_wp - s)**2*slope(:, 1) &
            & - s**2*(1.0_wp - s)*slope(:, 2)
         inside%x(:2, q) = matmul(x(:, curve%node(:4)), inside%shape(:, q))
         inside%part(:, q) = line(:, q)*inside%area(q)
      end do
   end subroutine curve_points

   !> Shares in the slope at a node, over a facet of length h that begins there, of the node, of the
   !> facet's other one and of that before it: of the parabola through the three.
   pure function bend(h, before) result(share)
      real(wp), intent(in) :: h, before        !! [length]
      real(wp) :: share(3)

      share(2) = before/(h + before)
      share(3) = -h**2/(before*(h + before))
      share(1) = -share(2) - share(3)
   end function bend
end module lopin_curved_slave
