!> Meshed masters that go into the slave where its rows do not see them: a rib between two nodes, a
!> corner deep inside a facet.
!>
!> Looked at where a step ends, on the present shape.
module lopin_narrow_masters
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type, cell_id
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, new_facets
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_model, only : model_type, surface_of
   use lopin_scene, only : scene_type
   use lopin_placed_tool, only : find_places, presses_by_faces
   use lopin_mortar_pairs, only : is_mortar
   use lopin_master_entries, only : entry_type, find_entries, width_of
   use lopin_lost_approach, only : check_lost_approach, deepest_contact
   use lopin_narrow_tools, only : open_by, too_deep
   use lopin_narrow_ribs, only : check_narrow_ribs
   use lopin_present_gaps, only : gap_of
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_narrow_masters

   real(wp), parameter :: rounding = 1.0e-6_wp   !! of a facet: nothing goes in by less
   real(wp), parameter :: well_beyond_half = 0.6_wp   !! of a facet

contains

   subroutine check_narrow_masters(scene, model, work)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: work             !! stored and spent in the bodies [energy]
      type(cell_type), allocatable :: cells(:)
      type(surface_type) :: slave, master
      type(error_type), allocatable :: error
      real(wp) :: x(model%mesh%ndim, model%mesh%nnode)
      integer :: pair

      call cells_of_words(model%element_word, cells)
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            if (model%surface(p%master)%kind /= surface_of%faces) cycle
            if (p%slave == p%master .or. .not. presses_by_faces(scene, model, pair)) cycle
            call find_places(scene, model, x)
            call stand(p%slave, slave)
            if (.not. allocated(error)) call stand(p%master, master)
            ! Facets without area: said elsewhere.
            if (allocated(error)) cycle
            call check_pair(scene, model, cells, pair, slave, master, x, work)
            if (.not. is_mortar(model, p)) call check_narrow_ribs(scene, model, pair, slave, &
               & master, x)
         end associate
      end do

   contains

      !> A surface where it is now.
      subroutine stand(number, surface)
         integer, intent(in) :: number
         type(surface_type), intent(out) :: surface
         type(facets_type) :: facets

         call new_facets(facets, model%mesh, cells, model%surface(number)%element, &
            & model%surface(number)%face)
         call new_surface(surface, model%mesh%ndim, facets)
         call update_surface(surface, x, error)
      end subroutine stand
   end subroutine check_narrow_masters

   subroutine check_pair(scene, model, cells, pair, slave, master, x, work)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: work             !! [energy]
      type(entry_type) :: entry(slave%facets%n)
      real(wp) :: least(size(x, 2)), shift(size(x, 2)), own(size(x, 2))
      real(wp) :: depth, deepest, top, allowed
      integer :: i, worst
      logical :: yields

      call node_gaps(scene, model, pair, least, shift)
      ! A law that gives way lets the nodes in: what is inside counts from where they are.
      own = shift
      if (.not. is_mortar(model, model%pair(pair))) where (least < huge(1.0_wp)) own = shift &
         & + max(0.0_wp, -least)
      call find_entries(slave, master, x, deepest_contact(scene, pair), own, entry)
      call check_lost_approach(scene, model, pair, slave%facets, entry, work)
      if (.not. any(entry%depth > rounding*slave%size)) return
      yields = scene%accepted%solids%in_use .and. .not. is_mortar(model, model%pair(pair))
      worst = 0
      deepest = 0.0_wp
      do i = 1, slave%facets%n
         associate (node => slave%facets%node(:slave%facets%nnode(i), i), long => slave%size(i))
            top = minval(least(node))
            depth = entry(i)%depth - max(0.0_wp, maxval(shift(node)))
            if (depth <= rounding*long .or. depth <= deepest*long) cycle
            ! Past an edge of the master the node that touches bears for half of the facet: what is
            ! inside beyond that has no force, and metal that flows bears no more elsewhere.
            allowed = merge(open_by, too_deep, yields .and. maxval(least(node)) > open_by*long &
               & .and. width_of(entry(i), size(x, 1)) > well_beyond_half*long)
            if (top <= open_by*long .and. depth + top <= allowed*long) cycle
            if (.not. is_filled(model, cells, x, entry(i)%ahead(:size(x, 1)))) cycle
            deepest = depth/long
            worst = i
         end associate
      end do
      if (worst == 0) return
      call tell(scene, model, pair, slave%facets, worst, deepest*slave%size(worst), &
         & width_of(entry(worst), size(x, 1)), slave%size(worst))
   end subroutine check_pair

   subroutine tell(scene, model, pair, f, worst, deepest, width, long)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, worst         !! worst: facet of the slave
      type(facets_type), intent(in) :: f
      real(wp), intent(in) :: deepest, width, long   !! [length]

      associate (p => model%pair(pair))
         call warn_once(scene%log, 'W0339', model%surface(p%master)%name//' goes into face S'// &
            & to_text(f%face(worst))//' of element '// &
            & to_text(model%mesh%element_label(f%element(worst)))//' of '// &
            & model%surface(p%slave)%name//' between its nodes, by '//to_text(deepest, 3)// &
            & '; it is about '//to_text(width, 3)//' wide there, the facet '// &
            & to_text(long, 3)//' long', p%at, &
            & help='facets of '//model%surface(p%slave)%name//' at most as long as '// &
            & model%surface(p%master)%name//' is wide there, TYPE=SURFACE TO SURFACE, or '// &
            & 'exchange slave and master')
      end associate
   end subroutine tell

   !> Gaps of the slave's nodes as their rows have them, and what CLEARANCE or ADJUST add to them.
   subroutine node_gaps(scene, model, pair, least, shift)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(out) :: least(:)        !! (nnode) huge: none [length]
      real(wp), intent(out) :: shift(:)        !! (nnode) [length]
      integer :: i

      least = huge(1.0_wp)
      shift = 0.0_wp
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            do i = 1, c%n
               if (c%pair(i) /= pair .or. c%facet(i) == 0) cycle
               call take(c%node(i), c%opening(i), c%shift(i), c%status(i) > 0)
            end do
         end associate
         return
      end if
      do i = scene%points%first(pair), scene%points%first(pair + 1) - 1
         if (scene%points%facet(i) == 0) cycle
         call take(scene%points%node(i), gap_of(scene, model, i), scene%initial%shift(i), .false.)
      end do

   contains

      subroutine take(node, gap, moved, closed)
         integer, intent(in) :: node
         real(wp), intent(in) :: gap, moved
         logical, intent(in) :: closed
         least(node) = min(least(node), gap)
         if (closed) least(node) = min(least(node), 0.0_wp)
         if (abs(moved) > abs(shift(node))) shift(node) = moved
      end subroutine take
   end subroutine node_gaps

   !> Some element is there: beyond a thin wall nothing is entered.
   pure logical function is_filled(model, cells, x, at)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      real(wp), intent(in) :: x(:, :), at(:)
      real(wp) :: low(size(at)), high(size(at)), slack
      integer :: e

      is_filled = .false.
      do e = 1, model%mesh%nelement
         associate (cell => cells(model%mesh%etype(e)))
            if (cell%ndim < size(at)) cycle
            associate (node => model%mesh%conn(:cell%nnode, e))
               low = minval(x(:, node), 2)
               high = maxval(x(:, node), 2)
               slack = rounding*maxval(high - low)
               if (any(low > at + slack) .or. any(high < at - slack)) cycle
               is_filled = holds(cell, x(:, node), at, slack)
            end associate
         end associate
         if (is_filled) return
      end do
   end function is_filled

   !> A place is behind all faces of an element, as planes through their corners.
   pure logical function holds(cell, x, at, slack)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(in) :: at(:), slack     !! [length]
      real(wp) :: one(3), two(3), normal(3)
      integer :: k, d

      d = size(at)
      holds = .false.
      do k = 1, cell%nface
         associate (node => cell%face_node(:, k))
            one = 0.0_wp
            two = [0.0_wp, 0.0_wp, 1.0_wp]
            one(:d) = x(:, node(2)) - x(:, node(1))
            if (d == 3) two = x(:, node(3)) - x(:, node(1))
            if (is_quad(cell%face_cell(k))) then
               one(:d) = x(:, node(3)) - x(:, node(1))
               two(:d) = x(:, node(4)) - x(:, node(2))
            end if
            normal = cross(one, two)
            if (dot_product(normal(:d), at - x(:, node(1))) > slack*norm2(normal)) return
         end associate
      end do
      holds = .true.
   end function holds

   pure logical function is_quad(id)
      integer, intent(in) :: id
      is_quad = any(id == [cell_id%quad, cell_id%quad8])
   end function is_quad
end module lopin_narrow_masters
