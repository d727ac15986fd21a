!> The first search of contact, pair by pair, in words.
module lopin_first_contact
   use lopin_kinds, only : wp
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_contact_points, only : contact_points_type, pair_is_tied
   use lopin_initial_gaps, only : initial_gap_type, may_tie
   implicit none
   private
   public :: describe_pair

   !> Digits of lengths and of components of a direction.
   integer, parameter :: digits = 5, rough = 3

contains

   !> Lines on a pair: the points that face the master, the gaps and where they are, the side.
   function describe_pair(points, initial, model, pair) result(text)
      type(contact_points_type), intent(in) :: points   !! of all pairs at the start
      type(initial_gap_type), intent(in) :: initial
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      character(len=:), allocatable :: text
      character(len=*), parameter :: nl = new_line('a')
      integer :: i, near, far, facing, nodes, alone

      associate (p => model%pair(pair))
         text = 'pair ('//model%surface(p%slave)%name//', '//model%surface(p%master)%name//'): '
         if (p%slave == p%master) then
            text = text//'the surface against itself, searched in every increment'
            return
         end if
         call count_points(points, pair, nodes, facing, alone, near, far)
         text = text//plural(nodes, 'slave node')//', '//to_text(facing)//' face the master'
         if (alone > 0) text = text//', '//to_text(nodes - facing)//' have none (first: '// &
            & place_of(model, points%node(alone))//')'
         if (facing == 0) return
         text = text//nl//'  gaps from '//to_text(points%gap(near), digits)//' at '// &
            & place_of(model, points%node(near))//' to '//to_text(points%gap(far), digits)// &
            & ' at '//place_of(model, points%node(far))
         associate (first => points%first(pair), last => points%first(pair + 1) - 1)
            if (pair_is_tied(model, p)) then
               text = text//'; '//to_text(count([(may_tie(points, i, p%adjust), &
                  & i=first, last)]))//' are tied'
            else
               text = text//'; '//to_text(count(initial%touches(first:last)))// &
                  & ' closed at the start, '//to_text(count(initial%overclosure(first:last) &
                  & > 0.0_wp))//' of them pushed out'
            end if
            if (p%has_clearance) text = text//'; *CLEARANCE makes each '// &
               & to_text(p%clearance, digits)
         end associate
         if (points%gap(near) > reach_of(model)) text = text//nl//'  the smallest gap is wider '// &
            & 'than anything is prescribed to move: the pair will not close'
         text = text//nl//'  outward side of '//model%surface(p%master)%name//' there: '// &
            & shown(points%normal(:model%mesh%ndim, near), rough)
      end associate
   end function describe_pair

   !> How far bodies and tools may come: twice the largest prescribed way; without end where forces,
   !> rotations, velocities or temperatures act.
   pure real(wp) function reach_of(model) result(reach)
      type(model_type), intent(in) :: model
      integer :: s, k
      logical :: free

      reach = 0.0_wp
      free = .false.
      do s = 1, size(model%step)
         associate (step => model%step(s))
            free = free .or. size(step%point_load) + size(step%face_load) + size(step%body_load) &
               & + size(step%temperature) > 0
            do k = 1, size(step%prescribed)
               associate (p => step%prescribed(k))
                  if (.not. abs(p%value) > 0.0_wp) cycle
                  free = free .or. p%velocity .or. p%dof > 3 .or. p%amplitude > 0
                  reach = max(reach, 2.0_wp*abs(p%value))
               end associate
            end do
         end associate
      end do
      if (free) reach = huge(1.0_wp)
   end function reach_of

   !> Nodes of the slave, those with a master, one without, and the points nearest and farthest.
   pure subroutine count_points(points, pair, nodes, facing, alone, near, far)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair
      integer, intent(out) :: nodes, facing, alone, near, far
      integer :: i, last

      nodes = 0
      facing = 0
      alone = 0
      near = 0
      far = 0
      i = points%first(pair)
      do while (i < points%first(pair + 1))
         ! A point in a corner of a tool has an entry for each wall.
         last = i
         do while (last + 1 < points%first(pair + 1))
            if (points%node(last + 1) /= points%node(i)) exit
            last = last + 1
         end do
         nodes = nodes + 1
         if (any(points%facet(i:last) > 0)) facing = facing + 1
         if (alone == 0 .and. all(points%facet(i:last) == 0)) alone = i
         do i = i, last
            if (points%facet(i) == 0) cycle
            if (near == 0) near = i
            if (far == 0) far = i
            if (points%gap(i) < points%gap(near)) near = i
            if (points%gap(i) > points%gap(far)) far = i
         end do
         i = last + 1
      end do
   end subroutine count_points

   function place_of(model, node) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      character(len=:), allocatable :: text
      text = 'node '//to_text(model%mesh%node_label(node))//' '// &
         & shown(model%mesh%x(:, node), digits)
   end function place_of

   function shown(x, figures) result(text)
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: figures
      character(len=:), allocatable :: text
      integer :: k

      text = '('
      do k = 1, size(x)
         if (k > 1) text = text//', '
         if (abs(x(k)) < 10.0_wp**(-figures - 3)*maxval(abs(x))) then
            text = text//'0'
         else
            text = text//to_text(x(k), figures)
         end if
      end do
      text = text//')'
   end function shown
end module lopin_first_contact
