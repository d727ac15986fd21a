!> One contact point: which dofs it couples, its forces, and their exact derivatives by dual
!> numbers.
module lopin_contact_element
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, constant, dual_dot, dual_cross, &
      & operator(+), operator(-), operator(*), operator(/), assignment(=)
   use lopin_local_matrix, only : local_matrix_type
   use lopin_contact_row, only : row_type, point_state_type, point_law_type
   use lopin_row_element, only : begin_row, press_row, last_block, end_row
   use lopin_contact_foot, only : facet_place_type, facet_foot, smooth_facet_foot, tool_foot, &
      & tool_motion, turned, turned_back
   use lopin_nonlinear_points, only : growth_type
   use lopin_contact_inputs, only : point_view_type, inputs_type, list_inputs
   use lopin_tool_samples, only : place_type, find_foot, mean_place, place_inner, place_planes, &
      & soft_least
   implicit none
   private
   public :: evaluate_point

contains

   !> Forces of the point on the dofs that it couples, and their exact tangent in the local matrix.
   subroutine evaluate_point(state, local, point, law)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(point_view_type), intent(in) :: point
      type(point_law_type), intent(in) :: law
      type(inputs_type) :: inputs
      type(dual_type), allocatable :: force(:)
      type(row_type) :: row
      type(dual_type) :: z(3), shares(point%opposite%nnode), reference(3), arm(3)
      type(place_type) :: there(3)
      type(place_type), allocatable :: inner(:), around(:)
      type(dual_type), allocatable :: bears(:)  !! what `inner` have of the row's pressure
      real(wp) :: weight                       !! [area]
      integer :: columns, d, places, pair

      d = point%model%mesh%ndim
      state%reaction = 0.0_wp
      weight = point%points%weight(point%i)
      pair = point%points%pair(point%i)
      call list_inputs(inputs, point, law%first_row)
      columns = inputs%n
      if (law%with_tangent .and. (law%follows .or. allocated(point%points%growth(point%i)%slope))) &
         & then
         columns = inputs%n + 1
         inputs%growth = columns
      end if
      local%dof = inputs%dof(:inputs%n)
      local%nu = inputs%nu
      allocate (force(inputs%nu))
      row%ndim = d
      row%shift = law%shift
      row%weight = weight
      row%held_gap = point%anchor%gap
      row%has_rows = law%first_row > 0
      call begin_row(row, local, columns, law%with_tangent)
      do
         call find_gap(row%from)
         call press_row(row, law, variable(law%at%growth, inputs%growth - row%from))
         call share_force()
         if (last_block(row, local, force)) exit
      end do
      call end_row(state, local, row, law%enforcement, force)
      if (law%follows .and. inputs%growth > 0) local%by_bound = law%at%growth &
         & *local%k(:, inputs%growth)
      if (inputs%growth > 0) call add_growth(local, point%points%growth(point%i))

   contains

      !> Gap, normal and slip of the point, with slopes along inputs from+1 and on.
      subroutine find_gap(from)
         integer, intent(in) :: from
         type(dual_type) :: x(3)
         integer :: k

         x = 0.0_wp
         row%multiplier = constant(0.0_wp)
         do k = 1, d
            x(k) = variable(point%masters%x(k, point%points%node(point%i)), inputs%slave(k) - from)
            row%multiplier(k) = variable(law%lambda(k), inputs%multiplier(k) - from)
         end do
         if (point%opposite%nnode > 0) then
            call find_gap_to_facet(from, x, row%gap, row%normal, row%arm)
         else
            call find_gap_to_tool(from, x, row%gap, row%normal, row%arm)
         end if
         row%slip = row%arm - row%normal*dual_dot(row%arm, row%normal)
      end subroutine find_gap

      subroutine find_gap_to_facet(from, x, gap, n, to_anchor)
         integer, intent(in) :: from
         type(dual_type), intent(in) :: x(3)
         type(dual_type), intent(inout) :: gap, n(3), to_anchor(3)
         type(dual_type) :: node(3, point%opposite%nnode)
         integer :: k, m

         associate (o => point%opposite, anchor => point%anchor, places => point%masters%x)
            do m = 1, o%nnode
               do k = 1, d
                  node(k, m) = variable(places(k, o%node(m)), inputs%master(k, m) - from)
               end do
            end do
            if (allocated(o%stencil)) then
               call smooth_facet_foot(point%basis, facet_place_type(o%cell, o%found, o%feature, &
                  & o%size), x, node, o%stencil, gap, n, shares(:o%ncarry))
            else
               call facet_foot(point%basis, facet_place_type(o%cell, o%found, o%feature, o%size), &
                  & x, node, gap, n, shares)
            end if
            to_anchor = x
            do m = 1, anchor%nnode
               do k = 1, d
                  to_anchor(k) = to_anchor(k) - anchor%share(m)*variable(places(k, &
                     & anchor%node(m)), inputs%anchor(k, m) - from)
               end do
            end do
         end associate
      end subroutine find_gap_to_facet

      !> What several places of the slave face give is in `there`, `around` and `inner`.
      subroutine find_gap_to_tool(from, x, gap, n, to_anchor)
         integer, intent(in) :: from
         type(dual_type), intent(in) :: x(3)
         type(dual_type), intent(inout) :: gap, n(3), to_anchor(3)
         type(dual_type) :: rotation(3, 3), y(3), turn(3)
         integer :: k

         associate (motion => point%masters%of(pair)%motion, &
            & body => point%masters%of(pair)%body)
            turn = 0.0_wp
            reference = constant(motion%reference + motion%displacement)
            rotation = constant(motion%rotation)
            if (body > 0) then
               do k = 1, d
                  reference(k) = variable(motion%reference(k) + motion%displacement(k), &
                     & inputs%reference(k) - from)
               end do
               do k = 1, 3
                  turn(k) = variable(point%masters%of(pair)%rotation(k), &
                     & inputs%rotation(k) - from)
               end do
               rotation = tool_motion(turn)
            end if
            arm = x - reference
            y = constant(motion%reference) + turned_back(rotation, arm)
            call tool_foot(point%opposite%foot, y, gap, turn)
            n = turned(rotation, turn)
            to_anchor = arm - turned(rotation, constant(point%anchor%y - motion%reference))
            state%opening = gap%v
            state%beyond = 0.0_wp
            there(1) = place_type(1.0_wp, x, n, gap, inputs%slave)
            places = 1
            if (allocated(point%opposite%sample)) then
               call add_samples(from, rotation, motion%reference)
               call mean_place(there, gap, to_anchor)
               state%beyond = gap%v - state%opening
               to_anchor = to_anchor - turned(rotation, constant(point%anchor%offset))
            end if
            if (allocated(point%opposite%inner)) then
               call add_inner(from, rotation, motion%reference, gap)
               state%beyond = 0.0_wp
            end if
         end associate
      end subroutine find_gap_to_tool

      !> Points beside the node that have a share in its row.
      subroutine add_samples(from, rotation, start)
         integer, intent(in) :: from
         type(dual_type), intent(in) :: rotation(3, 3)
         real(wp), intent(in) :: start(3)      !! reference point before it moved [length]
         integer :: k, m

         places = 3
         do m = 1, 2
            associate (s => point%opposite%sample(m))
               there(1)%c = there(1)%c - s%c
               there(1 + m)%c = s%c
               there(1 + m)%input = inputs%sample(:, m)
               there(1 + m)%x = 0.0_wp
               do k = 1, d
                  there(1 + m)%x(k) = variable(point%masters%x(k, s%node), &
                     & inputs%sample(k, m) - from)
               end do
               call find_foot(there(1 + m), s, there(1), rotation, reference, start)
            end associate
         end do
      end subroutine add_samples

      !> Points inside the facets: their gaps to the tool, in its tangent planes and as it bends.
      subroutine add_inner(from, rotation, start, gap)
         integer, intent(in) :: from
         type(dual_type), intent(in) :: rotation(3, 3)
         real(wp), intent(in) :: start(3)      !! reference point before it moved [length]
         type(dual_type), intent(inout) :: gap
         type(dual_type) :: base
         integer :: m

         if (.not. allocated(around)) allocate (around(size(point%opposite%inner%node)), &
            & inner(size(point%opposite%inner%bent)), bears(size(point%opposite%inner%bent)))
         base = gap
         associate (points_inside => point%opposite%inner)
            call place_planes(around, gap, points_inside, inputs, point%masters%x, rotation, &
               & reference, from)
            do m = 1, size(inner)
               call place_inner(inner(m), points_inside%bent(m), around, rotation, reference, start)
            end do
            if (points_inside%soft > 0.0_wp) then
               call soft_least(inner, points_inside, gap, bears)
            else
               do m = 1, size(inner)
                  bears(m) = constant(inner(m)%c)
                  gap = gap + inner(m)%c*inner(m)%gap
               end do
            end if
            gap = gap + (1.0_wp - points_inside%c)*base
         end associate
      end subroutine add_inner

      !> Forces on the inputs: the traction of the row, shared among the nodes.
      subroutine share_force()
         type(dual_type) :: moment(3)
         integer :: k, m

         force = constant(0.0_wp)
         associate (gap => row%gap, n => row%normal)
            z = weight*row%z
            state%normal = n%v
            state%traction = z%v/weight
            if (allocated(point%opposite%inner)) then
               call push_places(there(:places), z, n, reference, 1.0_wp - point%opposite%inner%c)
               call push_inner(around, inner, dual_dot(z, n), reference)
               return
            end if
            if (allocated(point%opposite%sample)) then
               call push_places(there, z, n, reference, 1.0_wp)
               return
            end if
            do k = 1, d
               call push(inputs%slave(k), z(k))
               do m = 1, point%opposite%ncarry
                  call push(inputs%master(k, m), (-1.0_wp)*(shares(m)*z(k)))
               end do
               call push(inputs%reference(k), (-1.0_wp)*z(k))
            end do
            if (any(inputs%rotation > 0)) then
               moment = dual_cross(arm - merge(0.0_wp, 1.0_wp, law%enforcement%tied)*(n*gap), z)
               do k = 1, 3
                  call push(inputs%rotation(k), (-1.0_wp)*moment(k))
               end do
            end if
         end associate
      end subroutine share_force

      !> Forces of a row with several places: pressures along the normal of each, shears along the
      !> point's tangents; the tool has the reactions.
      subroutine push_places(there, z, n, reference, part)
         type(place_type), intent(in) :: there(:)
         type(dual_type), intent(in) :: z(3), n(3), reference(3)   !! z: force of the row
         real(wp), intent(in) :: part          !! of the pressure that acts here
         type(dual_type) :: own(3), press
         integer :: m, k

         press = dual_dot(z, n)
         do m = 1, size(there)
            associate (p => there(m))
               own = z
               if (.not. law%enforcement%tied) own = z + press*(part*p%normal - n)
               own = p%c*own
               do k = 1, d
                  call push(p%input(k), own(k))
               end do
               call hold(p, own, reference)
            end associate
         end do
      end subroutine push_places

      !> Pressures push each place inside the facets along its own normal.
      subroutine push_inner(around, inner, press, reference)
         type(place_type), intent(in) :: around(:), inner(:)
         type(dual_type), intent(in) :: press, reference(3)   !! press: of the row [force]
         type(dual_type) :: own(3)
         integer :: m, j, k

         do m = 1, size(around)
            own = press*around(m)%normal
            call hold(around(m), own, reference)
            do k = 1, d
               call push(around(m)%input(k), own(k))
            end do
         end do
         do m = 1, size(inner)
            own = (bears(m)*press)*inner(m)%normal
            call hold(inner(m), own, reference)
            associate (s => point%opposite%inner%bent(m))
               do j = 1, s%nnode
                  do k = 1, d
                     call push(around(s%at(j))%input(k), s%shape(j)*own(k))
                  end do
               end do
            end associate
         end do
      end subroutine push_inner

      !> The tool bears a force at a foot.
      subroutine hold(p, own, reference)
         type(place_type), intent(in) :: p
         type(dual_type), intent(in) :: own(3), reference(3)
         type(dual_type) :: arm(3), moment(3)
         integer :: k
         do k = 1, d
            call push(inputs%reference(k), (-1.0_wp)*own(k))
         end do
         if (all(inputs%rotation == 0)) return
         arm = p%x - reference
         arm = arm - merge(0.0_wp, 1.0_wp, law%enforcement%tied)*(p%normal*p%gap)
         moment = dual_cross(arm, own)
         do k = 1, 3
            call push(inputs%rotation(k), (-1.0_wp)*moment(k))
         end do
      end subroutine hold

      subroutine push(input, f)
         integer, intent(in) :: input
         type(dual_type), intent(in) :: f
         if (input > 0) force(input) = force(input) + f
      end subroutine push
   end subroutine evaluate_point

   !> The last column, slopes in the growth of the area, becomes one for each dof that it reads.
   pure subroutine add_growth(local, growth)
      type(local_matrix_type), intent(inout) :: local
      type(growth_type), intent(in) :: growth
      real(wp), allocatable :: k(:, :)
      integer :: n, j

      n = size(local%dof)
      if (.not. (allocated(growth%slope) .and. any(abs(local%k(:, n + 1)) > 0.0_wp))) then
         local%k = local%k(:, :n)
         return
      end if
      local%dof = [local%dof, growth%dof]
      allocate (k(size(local%dof), size(local%dof)), source=0.0_wp)
      k(:n, :n) = local%k(:, :n)
      do j = 1, size(growth%dof)
         k(:n, n + j) = local%k(:, n + 1)*growth%slope(j)
      end do
      call move_alloc(k, local%k)
   end subroutine add_growth
end module lopin_contact_element
