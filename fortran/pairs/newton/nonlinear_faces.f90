!> Points inside the facets that meet creases of a tool, on the present shape.
!>
!> As lopin_face_rows for the linear paths: which facets have such points follows the motion; what
!> each point counts is taken from the shape where the increment begins.
module lopin_nonlinear_faces
   use lopin_kinds, only : wp
   use lopin_tool, only : foot_type
   use lopin_model, only : model_type
   use lopin_contact_points, only : face_type
   use lopin_face_points, only : face_points_type, place_points
   use lopin_face_rows, only : points_of_face, face_feet_type, find_feet
   use lopin_curved_slave, only : curve_points, soft_length
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_closest_feature, only : opposite_type, inner_row_type, inner_foot_type
   use lopin_master_surfaces, only : masters_type
   implicit none
   private
   public :: find_inner_feet, start_gap_of

   !> Facets whose nodes are all farther away, in facets, are not looked at.
   real(wp), parameter :: near = 1.0_wp

contains

   !> The points inside facets that the rows of all points have now.
   !>
   !> A facet that has met a crease, or a curve, has them to the end of the increment: on curved
   !> tools a row with them differs by sags from one without, and gaps would leap within Newton
   !> where a facet grazes a crease.
   subroutine find_inner_feet(opposite, masters, points, model, x, met)
      type(opposite_type), intent(inout) :: opposite(:)
      type(masters_type), intent(in) :: masters
      type(nonlinear_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) where the increment began [length]
      logical, intent(inout) :: met(:)         !! (facets) since the increment began
      type(face_points_type) :: inside
      type(face_feet_type) :: feet
      real(wp) :: normal(3, 8), stretch(64)
      integer :: i, k, n

      do i = 1, size(opposite)
         if (allocated(opposite(i)%inner)) deallocate (opposite(i)%inner)
      end do
      do i = 1, size(points%face)
         associate (f => points%face(i), m => masters%of(points%face(i)%pair))
            n = f%nnode
            if (any(opposite(f%point(:n))%facet == 0)) cycle
            if (.not. (met(i) .or. is_near(opposite, points, f))) cycle
            call points_of_face(inside, f, model, x)
            if (f%curved) then
               call add_curve(opposite, masters, points, model, f, inside, met(i))
               cycle
            end if
            call place_points(inside, masters%x(:, f%node(:n)), stretch(:inside%n))
            do k = 1, n
               normal(:, k) = opposite(f%point(k))%normal
            end do
            call find_feet(model%tool(m%tool)%shape, m%motion, m%limits%extension &
               & *maxval(points%size(f%point(:n))), normal(:, :n), opposite(f%point(:n))%facet, &
               & inside, met(i), feet)
            if (.not. feet%found) cycle
            met(i) = met(i) .or. feet%meets
            if (met(i)) call add_points(opposite, points, f, n, inside, feet%foot)
         end associate
      end do
   end subroutine find_inner_feet

   !> The points of a facet that is curved, where it lies opposite a curve of its tool.
   subroutine add_curve(opposite, masters, points, model, face, inside, met)
      type(opposite_type), intent(inout) :: opposite(:)
      type(masters_type), intent(in) :: masters
      type(nonlinear_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(face_type), intent(in) :: face
      type(face_points_type), intent(inout) :: inside
      logical, intent(inout) :: met            !! a curve since the increment began
      type(face_type) :: curve
      type(foot_type) :: foot(inside%n)
      integer :: q

      associate (m => masters%of(face%pair), at => face%point(:2))
         call curve_points(inside, face, model%mesh%x, masters%x, curve)
         do q = 1, inside%n
            call model%tool(m%tool)%shape%project(m%motion%to_tool(inside%x(:2, q)), foot(q))
            if (.not. foot(q)%found) return
            if (foot(q)%overhang > m%limits%extension*maxval(points%size(at))) return
            met = met .or. any(abs(foot(q)%hessian(:2, :2)) > 0.0_wp)
         end do
         if (met) call add_points(opposite, points, curve, 2, inside, foot, soft_length)
      end associate
   end subroutine add_curve

   !> All nodes of a facet, which meet the tool, meet one side of it, and some node is near.
   pure logical function is_near(opposite, points, face)
      type(opposite_type), intent(in) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      type(face_type), intent(in) :: face
      integer :: k

      associate (at => face%point(:face%nnode))
         is_near = any(opposite(at)%foot%gap <= near*points%size(at))
      end associate
      do k = 1, face%nnode
         if (face%point(k) == points%n) cycle
         associate (i => face%point(k) + 1)
            if (points%entry(i) == 2 .and. opposite(i)%facet > 0) is_near = .false.
         end associate
      end do
   end function is_near

   !> The points of one facet to the rows of its nodes.
   subroutine add_points(opposite, points, face, nrow, inside, foot, soft)
      type(opposite_type), intent(inout) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      type(face_type), intent(in) :: face
      integer, intent(in) :: nrow              !! the first nodes, whose rows have the points
      type(face_points_type), intent(in) :: inside
      type(foot_type), intent(in) :: foot(:)
      real(wp), intent(in), optional :: soft   !! of the soft least gap, beside a facet [-]
      integer :: at(8), k, q

      do k = 1, nrow
         associate (own => opposite(face%point(k)), node => face%node(:face%nnode), &
            & part => inside%part(k, :inside%n)/points%weight(face%point(k)))
            if (.not. allocated(own%inner)) then
               allocate (own%inner)
               own%inner%node = [points%node(face%point(k))]
               allocate (own%inner%normal(3, 1), source=0.0_wp)
               allocate (own%inner%bent(0))
            end if
            call find_nodes(own%inner, node, at(:face%nnode))
            own%inner%c = own%inner%c + sum(part)
            if (present(soft)) own%inner%soft = soft*points%size(face%point(k))
            do q = 1, inside%n
               call add_point(own%inner, part(q), inside%shape(:, q), at(:face%nnode), foot(q))
            end do
         end associate
      end do
   end subroutine add_points

   !> Places of nodes in the list of a row, new ones at its end.
   pure subroutine find_nodes(row, node, at)
      type(inner_row_type), intent(inout) :: row
      integer, intent(in) :: node(:)
      integer, intent(out) :: at(:)
      real(wp), allocatable :: normal(:, :)
      integer :: k

      do k = 1, size(node)
         at(k) = findloc(row%node, node(k), dim=1)
         if (at(k) > 0) cycle
         row%node = [row%node, node(k)]
         at(k) = size(row%node)
      end do
      if (size(row%normal, 2) == size(row%node)) return
      allocate (normal(3, size(row%node)), source=0.0_wp)
      normal(:, :size(row%normal, 2)) = row%normal
      call move_alloc(normal, row%normal)
   end subroutine find_nodes

   pure subroutine add_point(row, c, shape, at, foot)
      type(inner_row_type), intent(inout) :: row
      real(wp), intent(in) :: c                !! part of the row
      real(wp), intent(in) :: shape(:)         !! N of the facet's nodes
      integer, intent(in) :: at(:)             !! their places in the row's list
      type(foot_type), intent(in) :: foot
      type(inner_foot_type) :: bent
      integer :: j

      if (foot%leans .or. row%soft > 0.0_wp .or. any(abs(foot%hessian) > 0.0_wp)) then
         bent%c = c
         bent%nnode = size(at)
         bent%at(:size(at)) = at
         bent%shape(:size(at)) = shape
         bent%foot = foot
         row%bent = [row%bent, bent]
         return
      end if
      row%gap = row%gap + c*foot%gap
      do j = 1, size(at)
         row%normal(:, at(j)) = row%normal(:, at(j)) + c*shape(j)*foot%normal
      end do
   end subroutine add_point

   !> Gap of a row of a tool, from the feet of the points inside its facets.
   pure real(wp) function start_gap_of(opposite, base) result(gap)
      type(opposite_type), intent(in) :: opposite
      real(wp), intent(in) :: base             !! the row's without such points [length]

      gap = base
      if (.not. allocated(opposite%inner)) return
      associate (row => opposite%inner)
         gap = (1.0_wp - row%c)*gap + row%gap
         if (row%soft > 0.0_wp) then
            gap = gap + row%c*soft_least(row%bent%c/row%c, row%bent%foot%gap, row%soft)
         else
            gap = gap + dot_product(row%bent%c, row%bent%foot%gap)
         end if
      end associate
   end function start_gap_of

   !> The soft least of gaps by shares whose sum is one.
   pure real(wp) function soft_least(share, gap, soft) result(least)
      real(wp), intent(in) :: share(:), gap(:), soft
      least = minval(gap)
      least = least - soft*log(dot_product(share, exp((least - gap)/soft)))
   end function soft_least
end module lopin_nonlinear_faces
