!> Loads and motions that cannot mean what they say: forces where a support takes them, pressures
!> inside a body, amplitudes that a step does not reach, degrees for radians.
module lopin_check_loads
   use lopin_kinds, only : wp
   use lopin_error, only : severity, location_type
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_model, only : model_type, step_type
   use lopin_check_free_turns, only : check_free_turns
   implicit none
   private
   public :: check_loads

   !> A line of *CLOAD.
   type :: line_type
      type(location_type) :: at
      integer :: node = 0, dof = 0           !! its first
      logical :: idle = .true.               !! so far, nothing that it loads can move
      logical :: loads = .false.             !! some force is not zero
   end type line_type

   real(wp), parameter :: full_turn = 8.0_wp*atan(1.0_wp)

contains

   subroutine check_loads(model)
      type(model_type), intent(inout) :: model
      logical, allocatable :: inside(:, :)
      integer :: s

      call check_forces(model)
      call check_free_turns(model)
      do s = 1, size(model%step)
         if (size(model%step(s)%face_load) > 0) then
            if (.not. allocated(inside)) call find_inside(model, inside)
            call check_faces(model, model%step(s), inside)
         end if
         call check_turns(model, model%step(s))
         call check_times(model, s)
      end do
      call check_start(model)
   end subroutine check_loads

   !> Lines whose forces all act where nothing can move, in every step that they reach: supports
   !> take them, or no body is there.
   subroutine check_forces(model)
      type(model_type), intent(inout) :: model
      type(line_type), allocatable :: line(:)
      logical, allocatable :: there(:)
      character(len=:), allocatable :: why
      integer :: s, i

      call find_bodies(model, there)
      allocate (line(0))
      do s = 1, size(model%step)
         if (size(model%step(s)%point_load) > 0) call read_lines(line, model, model%step(s), there)
      end do
      do i = 1, size(line)
         if (.not. line(i)%idle .or. .not. line(i)%loads) cycle
         why = '*BOUNDARY prescribes that displacement'
         if (.not. there(line(i)%node)) why = 'the node belongs to no element and to no rigid body'
         call model%log%say(severity%warning, 'W0405', 'the force at node '// &
            & to_text(model%mesh%node_label(line(i)%node))//', dof '//to_text(line(i)%dof)// &
            & ' does nothing: '//why, line(i)%at, &
            & help='load a node that can move; OP=NEW on *BOUNDARY takes supports away')
      end do
   end subroutine check_forces

   !> The lines of forces of a step, those that earlier steps have left among them.
   subroutine read_lines(line, model, step, there)
      type(line_type), allocatable, intent(inout) :: line(:)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      logical, intent(in) :: there(0:)
      logical, allocatable :: held(:, :)
      integer :: i, k

      allocate (held(6, model%mesh%nnode), source=.false.)
      do i = 1, size(step%prescribed)
         held(step%prescribed(i)%dof, step%prescribed(i)%node) = .true.
      end do
      do i = 1, model%mesh%nnode
         if (.not. there(i)) held(:, i) = .true.
      end do
      k = 0
      do i = 1, size(step%point_load)
         associate (load => step%point_load(i))
            if (k > 0) then
               if (.not. same(line(k)%at, load%at)) k = 0
            end if
            if (k == 0) then
               do k = size(line), 1, -1
                  if (same(line(k)%at, load%at)) exit
               end do
            end if
            if (k == 0) then
               line = [line, line_type(load%at, load%node, load%dof)]
               k = size(line)
            end if
            line(k)%idle = line(k)%idle .and. held(load%dof, load%node)
            line(k)%loads = line(k)%loads .or. abs(load%value) > 0.0_wp
         end associate
      end do
   end subroutine read_lines

   !> Nodes of elements, of rigid bodies and of equations.
   pure subroutine find_bodies(model, there)
      type(model_type), intent(in) :: model
      logical, allocatable, intent(out) :: there(:)      !! (0:nnode)
      integer :: e, i

      allocate (there(0:model%mesh%nnode), source=.false.)
      do e = 1, model%mesh%nelement
         there(model%mesh%conn(:, e)) = .true.
      end do
      do i = 1, size(model%rigid_body)
         there(model%rigid_body(i)%reference) = .true.
         there(model%rigid_body(i)%rotation) = .true.
         there(model%rigid_body(i)%node) = .true.
      end do
      do i = 1, size(model%equation)
         there(model%equation(i)%node) = .true.
      end do
      do i = 1, size(model%spring)
         there(model%spring(i)%node) = .true.
      end do
   end subroutine find_bodies

   pure logical function same(a, b)
      type(location_type), intent(in) :: a, b
      same = a%line == b%line .and. a%file == b%file
   end function same

   !> Faces that two elements share.
   subroutine find_inside(model, inside)
      type(model_type), intent(in) :: model
      logical, allocatable, intent(out) :: inside(:, :)   !! (6, nelement)
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      integer :: i

      call cells_of_words(model%element_word, cells)
      call boundary_facets(facets, model%mesh, cells, [(i, i=1, model%mesh%nelement)], .false., &
         & shared)
      allocate (inside(6, model%mesh%nelement), source=.true.)
      do i = 1, facets%n
         inside(facets%face(i), facets%element(i)) = .false.
      end do
      do i = 1, model%mesh%nelement
         if (model%mesh%section(i) == 0) inside(:, i) = .false.
      end do
   end subroutine find_inside

   !> Pressures on faces that two elements share, and faces that two lines load.
   subroutine check_faces(model, step, inside)
      type(model_type), intent(inout) :: model
      type(step_type), intent(in) :: step
      logical, intent(in) :: inside(:, :)      !! (6, nelement)
      integer, allocatable :: loaded(:, :)
      type(location_type) :: told
      integer :: i, number

      allocate (loaded(6, model%mesh%nelement), source=0)
      number = 0
      do i = 1, size(step%face_load)
         associate (load => step%face_load(i))
            if (inside(load%face, load%element)) number = number + 1
            if (number == 1 .and. inside(load%face, load%element)) call model%log%say( &
               & severity%warning, 'W0406', 'face '//to_text(load%face)//' of element '// &
               & to_text(model%mesh%element_label(load%element))//' is loaded, and lies '// &
               & 'between two elements', load%at, help='name the elements at the surface, or '// &
               & 'a *SURFACE for *DSLOAD')
            if (loaded(load%face, load%element) > 0) then
               if (.not. same(step%face_load(loaded(load%face, load%element))%at, load%at)) &
                  & call twice(loaded(load%face, load%element), i)
            end if
            loaded(load%face, load%element) = i
         end associate
      end do

   contains

      subroutine twice(first, second)
         integer, intent(in) :: first, second

         associate (a => step%face_load(first), b => step%face_load(second))
            if (same(told, b%at)) return
            told = b%at
            call model%log%say(severity%note, 'N0407', 'face '//to_text(b%face)// &
               & ' of element '//to_text(model%mesh%element_label(b%element))//' is loaded by '// &
               & 'line '//to_text(a%at%line)//' and by line '//to_text(b%at%line)// &
               & ': the loads are added', b%at)
         end associate
      end subroutine twice
   end subroutine check_faces

   !> More than a turn is often meant in degrees.
   subroutine check_turns(model, step)
      type(model_type), intent(inout) :: model
      type(step_type), intent(in) :: step
      integer :: i
      logical :: turns

      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            turns = p%dof > 3 .or. any(model%rigid_body%rotation == p%node)
            if (.not. turns .or. p%velocity .or. abs(p%value) <= full_turn) cycle
            call model%log%say(severity%note, 'N0402', 'a rotation by '//to_text(p%value, 5)// &
               & ' is '//to_text(abs(p%value)/full_turn, 3)//' turns: rotations are in radians', &
               & p%at)
         end associate
      end do
   end subroutine check_turns

   !> An amplitude in the time of a step that has no period goes on when the step has ended.
   subroutine check_times(model, s)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: s
      integer :: i

      associate (step => model%step(s))
         if (step%timed) return
         do i = 1, size(model%amplitude)
            associate (a => model%amplitude(i))
               if (a%total_time .or. a%time(size(a%time)) <= step%period) cycle
               if (.not. (any(step%prescribed%amplitude == i) &
                  & .or. any(step%point_load%amplitude == i) &
                  & .or. any(step%face_load%amplitude == i) &
                  & .or. any(step%body_load%amplitude == i))) cycle
               call model%log%say(severity%warning, 'W0408', 'amplitude '//a%name// &
                  & ' goes on until time '//to_text(a%time(size(a%time)), 5)//', and step '// &
                  & to_text(s)//' ends at '//to_text(step%period, 5)//', the period that '// &
                  & '*STATIC has without data', step%at, help='write the increment and the '// &
                  & 'period after *STATIC')
            end associate
         end do
      end associate
   end subroutine check_times

   !> Temperatures that rise from 0 because no line says where they start.
   subroutine check_start(model)
      type(model_type), intent(inout) :: model
      integer :: s

      if (.not. any(model%material%has_expansion)) return
      if (any(abs(model%temperature) > 0.0_wp)) return
      do s = 1, size(model%step)
         if (size(model%step(s)%temperature) == 0) cycle
         call model%log%say(severity%note, 'N0326', 'nothing is strained by heat at '// &
            & 'temperature 0: no *INITIAL CONDITIONS says another one', model%step(s)%at)
         return
      end do
   end subroutine check_start
end module lopin_check_loads
