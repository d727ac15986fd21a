!> Contact that is hardly wider than the facets that touch.
!>
!> Where curved bodies touch over few facets, the mesh does not show how wide the contact is: a
!> force on one node sinks in by what a facet makes of it, deeper on finer ones, and pressures are
!> forces over facets. How much of the answer that is, the work in the elements under such nodes
!> tells: most of it where a ball presses a block, little where a roller bends a beam.
module lopin_unresolved_contact
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, new_facets
   use lopin_model, only : model_type, surface_of
   use lopin_placed_tool, only : find_places, presses_by_faces
   use lopin_scene, only : scene_type
   use lopin_touched_width, only : find_closed, leave_narrow
   use lopin_repeated_messages, only : warn_once, note_once
   implicit none
   private
   public :: check_unresolved_contact

   !> What is off by so much is told, and warned of.
   real(wp), parameter :: told = 0.06_wp, warned = 0.1_wp
   !> A body is strained evenly where the share of its work under the contact is less than so many
   !> times the share of its height.
   real(wp), parameter :: denser = 1.1_wp
   !> Nodes of the master nearer to a closed one, in facets, are pressed by it.
   real(wp), parameter :: reach = 0.6_wp
   real(wp), parameter :: in_line = 0.02_wp   !! cosines of directions that are one

contains

   !> Look at the pairs where a step ends.
   subroutine check_unresolved_contact(scene, model, pressed, work)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: pressed(:)       !! (ndof) forces of contact [force]
      real(wp), intent(in) :: work             !! stored and spent in the bodies [energy]
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: slave, master
      logical :: narrow(model%mesh%nnode)
      real(wp) :: share
      integer :: pair, depth

      if (.not. work > 0.0_wp) return
      call cells_of_words(model%element_word, cells)
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            if (p%slave == p%master .or. .not. presses_by_faces(scene, model, pair)) cycle
            call find_closed(scene, pair, narrow)
            if (.not. any(narrow)) cycle
            slave = facets_of(p%slave)
            call leave_narrow(slave, narrow, depth)
            if (.not. any(narrow)) cycle
            if (model%surface(p%master)%kind == surface_of%faces) master = facets_of(p%master)
            if (model%surface(p%master)%kind /= surface_of%faces) master = facets_type()
            share = share_beside(scene, model, slave, master, narrow, pressed, work, depth)
            if (share**2 > told) call tell(scene, model, pair, narrow, share)
         end associate
      end do

   contains

      function facets_of(surface) result(facets)
         integer, intent(in) :: surface
         type(facets_type) :: facets
         call new_facets(facets, model%mesh, cells, model%surface(surface)%element, &
            & model%surface(surface)%face)
      end function facets_of
   end subroutine check_unresolved_contact

   !> Work that went into the elements under narrow contact, beside that in the bodies: forces of
   !> nodes over what these have sunk in beside the other side of their elements. 0 where elements
   !> farther away are strained as much.
   real(wp) function share_beside(scene, model, slave, master, narrow, pressed, work, depth) &
      & result(share)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(facets_type), intent(in) :: slave, master
      logical, intent(in) :: narrow(:)         !! (nnode)
      real(wp), intent(in) :: pressed(:)       !! (ndof) forces of contact [force]
      real(wp), intent(in) :: work             !! stored and spent in the bodies [energy]
      integer, intent(in) :: depth
      logical :: near(size(narrow))
      real(wp) :: x(model%mesh%ndim, model%mesh%nnode), sunk(3)

      near = narrow
      call find_places(scene, model, x)
      call add_opposite(slave, master, x, near)
      sunk = work_under(scene, model, slave, near, x, pressed) &
         & + work_under(scene, model, master, near, x, pressed)
      share = 0.5_wp*sunk(1)/work
      if (depth > 0 .and. share*sunk(3) < denser*sunk(2)) share = 0.0_wp
   end function share_beside

   !> Of the nodes of a surface [energy]; their forces by the part of the body's height that the
   !> elements under them have; their forces.
   function work_under(scene, model, f, near, x, pressed) result(total)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(facets_type), intent(in) :: f
      logical, intent(in) :: near(:)           !! (nnode)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(in) :: pressed(:)       !! (ndof) [force]
      real(wp) :: total(3), way(size(x, 1)), side(size(x, 1)), force(size(x, 1)), along, length
      real(wp) :: start(size(x, 1), size(near)), now(size(x, 1), size(near))
      integer :: node, d

      total = 0.0_wp
      if (f%n == 0) return
      call find_behind(model, f, near, x, start, now)
      do d = 1, size(side)
         associate (own => scene%bodies%body == scene%bodies%body(f%node(1, 1)))
            side(d) = maxval(x(d, :), mask=own) - minval(x(d, :), mask=own)
         end associate
      end do
      do node = 1, size(near)
         way = now(:, node) - x(:, node)
         if (.not. near(node) .or. .not. now(1, node) < huge(1.0_wp)) cycle
         force = 0.0_wp
         do d = 1, size(force)
            if (scene%dofs%id(d, node) > 0) force(d) = pressed(scene%dofs%id(d, node))
         end do
         along = max(0.0_wp, dot_product(force, way)/norm2(way))
         length = norm2(start(:, node) - model%mesh%x(:, node))
         total = total + along*[length - norm2(way), length*norm2(way) &
            & /dot_product(abs(way), side), 1.0_wp]
      end do
   end function work_under

   !> Behind each node, on the other side of the elements of its facets: the mean of the nodes most
   !> nearly along the normals of these, the farthest of several in line.
   pure subroutine find_behind(model, f, near, x, start, now)
      type(model_type), intent(in) :: model
      type(facets_type), intent(in) :: f
      logical, intent(in) :: near(:)           !! (nnode)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(out) :: start(:, :), now(:, :)   !! (ndim, nnode) [length]; huge: none
      integer :: times(size(near)), i, k, behind

      start = 0.0_wp
      now = 0.0_wp
      times = 0
      do i = 1, f%n
         do k = 1, f%nnode(i)
            associate (node => f%node(k, i))
               if (.not. near(node)) cycle
               behind = node_behind(model, f%node(:f%nnode(i), i), node, f%element(i))
               if (behind == 0) cycle
               start(:, node) = start(:, node) + model%mesh%x(:, behind)
               now(:, node) = now(:, node) + x(:, behind)
               times(node) = times(node) + 1
            end associate
         end do
      end do
      do i = 1, size(times)
         start(:, i) = merge(start(:, i)/max(1, times(i)), huge(1.0_wp), times(i) > 0)
         now(:, i) = merge(now(:, i)/max(1, times(i)), huge(1.0_wp), times(i) > 0)
      end do
   end subroutine find_behind

   !> The node of an element that lies behind one of its facet; 0: none.
   pure integer function node_behind(model, facet, node, element) result(behind)
      type(model_type), intent(in) :: model
      integer, intent(in) :: facet(:)          !! its nodes, corners first
      integer, intent(in) :: node, element
      real(wp) :: normal(3), way(3), along, best, farthest
      integer :: k, d

      behind = 0
      best = 0.0_wp
      farthest = 0.0_wp
      d = model%mesh%ndim
      associate (x => model%mesh%x)
         normal = [x(2, facet(2)) - x(2, facet(1)), x(1, facet(1)) - x(1, facet(2)), 0.0_wp]
         if (d == 3) normal = cross(x(:, facet(2)) - x(:, facet(1)), &
            & x(:, facet(3)) - x(:, facet(1)))
         do k = 1, size(model%mesh%conn, 1)
            associate (other => model%mesh%conn(k, element))
               if (other == 0) exit
               if (any(facet == other)) cycle
               way = 0.0_wp
               way(:d) = x(:, other) - x(:, node)
               along = abs(dot_product(way, normal))/norm2(way)
               if (along < best*(1.0_wp - in_line)) cycle
               if (along <= best*(1.0_wp + in_line) .and. norm2(way) <= farthest) cycle
               best = along
               farthest = norm2(way)
               behind = other
            end associate
         end do
      end associate
   end function node_behind

   !> Nodes of the master that are nearer to a narrow node than half a facet.
   subroutine add_opposite(slave, master, x, near)
      type(facets_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      logical, intent(inout) :: near(:)        !! (nnode)
      real(wp) :: length
      logical :: narrow(size(near))
      integer :: i, k

      if (master%n == 0) return
      narrow = near
      do i = 1, slave%n
         length = reach*norm2(x(:, slave%node(2, i)) - x(:, slave%node(1, i)))
         do k = 1, slave%nnode(i)
            if (narrow(slave%node(k, i))) call add_about(x(:, slave%node(k, i)), length)
         end do
      end do

   contains

      subroutine add_about(at, radius)
         real(wp), intent(in) :: at(:), radius   !! [length]
         integer :: m, j

         do m = 1, master%n
            do j = 1, master%nnode(m)
               associate (node => master%node(j, m))
                  near(node) = near(node) .or. norm2(x(:, node) - at) < radius
               end associate
            end do
         end do
      end subroutine add_about
   end subroutine add_opposite

   subroutine tell(scene, model, pair, narrow, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      logical, intent(in) :: narrow(:)         !! (nnode)
      real(wp), intent(in) :: share

      character(len=*), parameter :: remedy = &
         & 'facets a quarter as long there; *LOPIN, TARGET ERROR= finds how fine'
      character(len=:), allocatable :: text

      associate (p => model%pair(pair))
         text = 'contact of '//model%surface(p%slave)%name//' and '// &
            & model%surface(p%master)%name//' is hardly wider than a facet ('// &
            & to_text(count(narrow))//trim(merge(' nodes', ' node ', count(narrow) > 1))// &
            & '), and '//to_text(100.0_wp*share, 2)//' % of all work is in the elements under '// &
            & 'it: forces of given ways, or ways of given forces, may be off by some '// &
            & to_text(100.0_wp*share**2, 2)//' %'
         if (share**2 > warned) then
            call warn_once(scene%log, 'W0563', text, p%at, help=remedy)
         else
            call note_once(scene%log, 'N0563', text, p%at, help=remedy)
         end if
      end associate
   end subroutine tell
end module lopin_unresolved_contact
