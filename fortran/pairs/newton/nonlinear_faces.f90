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
   use lopin_face_rows, only : points_of_face, feet_on_crease
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
   subroutine find_inner_feet(opposite, masters, points, model, x)
      type(opposite_type), intent(inout) :: opposite(:)
      type(masters_type), intent(in) :: masters
      type(nonlinear_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) where the increment began [length]
      type(face_points_type) :: inside
      type(foot_type), allocatable :: foot(:)
      real(wp) :: normal(3, 8), stretch(64)
      integer :: i, k, n

      do i = 1, size(opposite)
         if (allocated(opposite(i)%inner)) deallocate (opposite(i)%inner)
      end do
      do i = 1, size(points%face)
         associate (f => points%face(i), m => masters%of(points%face(i)%pair))
            if (.not. is_met(opposite, points, f)) cycle
            n = f%nnode
            call points_of_face(inside, f, model, x)
            call place_points(inside, masters%x(:, f%node(:n)), stretch(:inside%n))
            do k = 1, n
               normal(:, k) = opposite(f%point(k))%normal
            end do
            if (feet_on_crease(model%tool(m%tool)%shape, m%motion, m%limits%extension &
               & *maxval(points%size(f%point(:n))), normal(:, :n), opposite(f%point(:n))%facet, &
               & inside, foot)) call add_points(opposite, points, f, inside, foot)
         end associate
      end do
   end subroutine find_inner_feet

   !> All nodes of a facet meet the tool, each one side of it, and some node is near.
   pure logical function is_met(opposite, points, face)
      type(opposite_type), intent(in) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      type(face_type), intent(in) :: face
      integer :: k

      is_met = .false.
      do k = 1, face%nnode
         associate (i => face%point(k))
            if (opposite(i)%facet == 0) return
            is_met = is_met .or. opposite(i)%foot%gap <= near*points%size(i)
         end associate
      end do
      do k = 1, face%nnode
         if (face%point(k) == points%n) cycle
         associate (i => face%point(k) + 1)
            if (points%entry(i) == 2 .and. opposite(i)%facet > 0) is_met = .false.
         end associate
      end do
   end function is_met

   !> The points of one facet to the rows of its nodes.
   subroutine add_points(opposite, points, face, inside, foot)
      type(opposite_type), intent(inout) :: opposite(:)
      type(nonlinear_points_type), intent(in) :: points
      type(face_type), intent(in) :: face
      type(face_points_type), intent(in) :: inside
      type(foot_type), intent(in) :: foot(:)
      integer :: at(8), k, q

      do k = 1, face%nnode
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

      if (foot%leans .or. any(abs(foot%hessian) > 0.0_wp)) then
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
         gap = (1.0_wp - row%c)*gap + row%gap + dot_product(row%bent%c, row%bent%foot%gap)
      end associate
   end function start_gap_of
end module lopin_nonlinear_faces
