!> Slave nodes that supports hold in directions in which their masters rest too.
!>
!> On a plane of symmetry the normal of a master of facets may lean out of the plane. Such a node
!> follows its master in what directions the supports leave, and there is no slip in the others:
!> rows that measured one would ask more of the node than it can do, and the traction along them
!> would work on supports alone. A mortar row at such a node measures what few free nodes of the
!> master do beside held ones: as for ties, the traction has no component there (lopin_tie_release).
module lopin_supported_points
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraints, only : constraints_type, expand, raw_displacement, axes_at
   use lopin_friction, only : has_friction
   use lopin_tie_release, only : released_directions
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_held_tools, only : find_held_tools
   implicit none
   private
   public :: find_supported_points

   !> Direction cosines, and ways beside a facet, that are rounding.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> A normal that leans so far into the plane that is left can be followed there.
   real(wp), parameter :: leans = 0.1_wp

contains

   !> By the supports of the step and what they move in the increment.
   subroutine find_supported_points(self, model, constraints, u, prescribed)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: u(:)             !! (ndof) where the increment begins
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed) where it ends
      real(wp) :: moved(size(u)), nil(constraints%neq), h(3)
      integer :: i, k

      nil = 0.0_wp
      call expand(constraints, nil, [(prescribed(i) - raw_displacement(constraints, self%dofs, u, &
         & constraints%dof_of_prescribed(i)), i=1, size(prescribed))], moved)
      call find_held_tools(self, model, constraints, moved)
      do i = 1, self%n
         associate (g => self%enforcement(i)%space)
            g%supported = .false.
            g%support = 0.0_wp
            g%limited = .false.
            if (self%enforcement(i)%tied .or. .not. has_friction(self%friction(self%pair(i)))) cycle
            if (self%opposite(i)%facet == 0) cycle
            if (self%mortar(self%pair(i))%is_on) call support_of_row(self, constraints, i, &
               & model%mesh%ndim, moved, g%support)
            do k = 1, model%mesh%ndim
               if (self%mortar(self%pair(i))%is_on) exit
               h = local_axis(constraints, self%node(i), k)
               if (.not. rests(constraints, self%dofs, self%node(i), 0, h, moved, &
                  & self%size(i))) cycle
               if (.not. master_rests(self, model, constraints, i, h, u, moved)) cycle
               g%support = g%support + spread(h, 2, 3)*spread(h, 1, 3)
            end do
            if (.not. any(abs(g%support) > 0.0_wp)) cycle
            h = self%start_normal(:, i) - matmul(g%support, self%start_normal(:, i))
            g%supported = norm2(h) > leans
            g%limited = g%supported
            g%taken = g%support
         end associate
      end do
   end subroutine find_supported_points

   !> Directions in which supports hold the node of a mortar row and most of the row's master.
   subroutine support_of_row(self, constraints, i, ndim, moved, support)
      type(nonlinear_contact_type), intent(in) :: self
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: i                 !! the point
      integer, intent(in) :: ndim
      real(wp), intent(in) :: moved(:)         !! (ndof) by prescribed values
      real(wp), intent(inout) :: support(3, 3) !! projector on these directions
      integer, allocatable :: node(:)
      real(wp), allocatable :: share(:)
      real(wp) :: basis(ndim, ndim), h(3)
      integer :: n, k, m
      logical :: rest

      call row_when_begun(self, i, node, share)
      if (size(node) < 2) return
      ! However well it is met by linear fields: a traction that it leaves free has no bounds.
      call released_directions(constraints, self%dofs, node, share, huge(1.0_wp), basis, n)
      do k = 1, n
         h = 0.0_wp
         h(:ndim) = basis(:, k)
         rest = rests(constraints, self%dofs, node(1), 0, h, moved, self%size(i))
         do m = 2, size(node)
            rest = rest .and. .not. abs(dot_product(h, way_of(self%dofs, node(m), 0, moved))) &
               & > rounding*self%size(i)
         end do
         if (rest) support = support + spread(h, 2, 3)*spread(h, 1, 3)
      end do
   end subroutine support_of_row

   !> Nodes of a mortar row where the increment begins, its own first, and their shares.
   subroutine row_when_begun(self, i, node, share)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i                 !! the point
      integer, allocatable, intent(out) :: node(:)
      real(wp), allocatable, intent(out) :: share(:)   !! [area]
      integer :: own

      node = [integer ::]
      share = [real(wp) ::]
      associate (mortar => self%mortar(self%pair(i)), anchor => self%mortar_anchor(i))
         if (mortar%in_space) then
            associate (row => mortar%space%before(i - mortar%first + 1))
               if (row%node == 0) return
               node = row%of
               share = row%c
            end associate
         else
            if (.not. anchor%set) return
            node = anchor%node
            share = anchor%coefficient
         end if
      end associate
      own = findloc(node, self%node(i), dim=1)
      if (own == 0) then
         node = [integer ::]
         return
      end if
      node([1, own]) = node([own, 1])
      share([1, own]) = share([own, 1])
   end subroutine row_when_begun

   !> Direction of a node's axis.
   pure function local_axis(constraints, node, k) result(h)
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: node, k
      real(wp) :: h(3)
      integer :: axes

      h = 0.0_wp
      h(k) = 1.0_wp
      axes = axes_at(constraints, node, k)
      if (axes > 0) h = constraints%axes(k, :, axes)
   end function local_axis

   !> No equation moves a node along a direction, nor do prescribed values in the increment.
   pure logical function rests(constraints, dofs, node, before, h, moved, unit)
      type(constraints_type), intent(in) :: constraints
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node
      integer, intent(in) :: before            !! 0: displacements; 3: rotations
      real(wp), intent(in) :: h(3)             !! unit vector
      real(wp), intent(in) :: moved(:)         !! (ndof) by prescribed values
      real(wp), intent(in) :: unit             !! a length of the point, or 1 rad
      real(wp) :: along
      integer :: k, j, a, b, id(3)

      id = 0
      do k = 1, 3
         if (before + k > size(dofs%id, 1)) exit
         id(k) = dofs%id(before + k, node)
      end do
      rests = abs(dot_product(way_of(dofs, node, before, moved), h)) <= rounding*unit
      do k = 1, 3
         if (id(k) == 0) cycle
         do a = constraints%first(id(k)), constraints%first(id(k) + 1) - 1
            along = 0.0_wp
            do j = 1, 3
               if (id(j) == 0) cycle
               do b = constraints%first(id(j)), constraints%first(id(j) + 1) - 1
                  if (constraints%equation(a) == constraints%equation(b)) along = along &
                     & + h(j)*constraints%coefficient(b)
               end do
            end do
            rests = rests .and. abs(along) <= rounding
         end do
      end do
   end function rests

   !> What prescribed values do to a node.
   pure function way_of(dofs, node, before, moved) result(way)
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node
      integer, intent(in) :: before            !! 0: displacements; 3: rotations
      real(wp), intent(in) :: moved(:)         !! (ndof) by prescribed values
      real(wp) :: way(3)
      integer :: k

      way = 0.0_wp
      do k = 1, 3
         if (before + k > size(dofs%id, 1)) exit
         if (dofs%id(before + k, node) > 0) way(k) = moved(dofs%id(before + k, node))
      end do
   end function way_of

   !> The tool, or the nodes that carry the point opposite, have no way along a direction.
   pure logical function master_rests(self, model, constraints, i, h, u, moved) result(rest)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: i                 !! the point
      real(wp), intent(in) :: h(3), u(:), moved(:)
      real(wp) :: beside
      integer :: k

      rest = .true.
      associate (master => self%masters%of(self%pair(i)), a => self%anchor(i))
         if (master%tool == 0) then
            rest = a%set
            if (rest) beside = share_beside(self, model, i, h, u)
            do k = 1, a%nnode
               if (abs(a%share(k)) <= beside) cycle
               rest = rest .and. rests(constraints, self%dofs, a%node(k), 0, h, moved, &
                  & self%size(i))
            end do
            return
         end if
         if (master%body == 0) return
         associate (node => model%rigid_body(master%body)%reference)
            rest = rests(constraints, self%dofs, node, 0, h, moved, self%size(i))
            if (rest) rest = turns_about(constraints, self%dofs, node, model%mesh%ndim, h, &
               & master%rotation, moved)
         end associate
      end associate
   end function master_rests

   !> What a gap gives nodes beside a plane of the foot: along a normal that leans out of the plane
   !> it lies beside it. Four times that: the normal turns along a facet, and nodes are not all as
   !> far.
   pure real(wp) function share_beside(self, model, i, h, u) result(share)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                 !! the point
      real(wp), intent(in) :: h(3)             !! normal of the plane
      real(wp), intent(in) :: u(:)             !! (ndof) where the increment begins
      real(wp) :: place(self%anchor(i)%nnode), wide
      integer :: k

      share = rounding
      associate (a => self%anchor(i), d => model%mesh%ndim)
         if (a%nnode < 2) return
         do k = 1, a%nnode
            place(k) = dot_product(h(:d), model%mesh%x(:d, a%node(k))) &
               & + dot_product(h, way_of(self%dofs, a%node(k), 0, u))
         end do
         wide = maxval(place) - minval(place)
         if (wide > rounding*self%size(i)) share = share &
            & + 4.0_wp*abs(a%gap*dot_product(h, self%start_normal(:, i)))/wide
      end associate
   end function share_beside

   !> A tool turns about a direction, or not at all: no point of it moves along the direction.
   pure logical function turns_about(constraints, dofs, node, ndim, h, rotation, moved)
      type(constraints_type), intent(in) :: constraints
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node, ndim
      real(wp), intent(in) :: h(3)
      real(wp), intent(in) :: rotation(3)      !! so far [rad]
      real(wp), intent(in) :: moved(:)
      real(wp) :: across(3, 3)
      integer :: k

      if (ndim == 2) then
         turns_about = rests(constraints, dofs, node, 3, [0.0_wp, 0.0_wp, 1.0_wp], moved, &
            & 1.0_wp)
         return
      end if
      turns_about = .true.
      across = -spread(h, 2, 3)*spread(h, 1, 3)
      do k = 1, 3
         across(k, k) = across(k, k) + 1.0_wp
         if (norm2(across(:, k)) <= rounding) cycle
         turns_about = turns_about .and. rests(constraints, dofs, node, 3, across(:, k) &
            & /norm2(across(:, k)), moved, 1.0_wp)
      end do
      if (norm2(matmul(across, rotation)) <= rounding) return
      turns_about = turns_about .and. rests(constraints, dofs, node, 3, h, moved, &
         & 1.0_wp)
   end function turns_about
end module lopin_supported_points
