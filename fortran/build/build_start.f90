!> *START and *REMESH: where a part of a run goes on, and that a mesh is to be made anew.
module lopin_build_start
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_text, only : to_text, parse_real, parse_integer
   use lopin_model, only : model_type
   use lopin_start, only : displaced_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & field_integer, complain
   use lopin_build_scene, only : scene_type, nodes_of, get_word
   implicit none
   private
   public :: build_start

contains

   !> Once steps and rigid bodies are known.
   subroutine build_start(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer :: k

      allocate (model%start%displaced(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == 'START') call read_start(model, scene, block, &
               & scene%card(k)%scope)
            if (block%keyword /= 'REMESH') cycle
            model%remesh_at = block%at
            model%remeshes = .true.
         end associate
      end do
      if (model%start%step > 0) call place_bodies(model)
   end subroutine build_start

   subroutine read_start(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(field_type), allocatable :: field(:)
      integer :: j, n

      if (model%start%step > 0) call complain(model%log, 'E0205', 'a second *START', block%at)
      call read_times(model, block)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n > 0) call read_place(model, scene, field(:n), scope)
      end do
   end subroutine read_start

   subroutine read_times(model, block)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: found

      associate (start => model%start)
         start%at = block%at
         call get_word(block, 'STEP', word, at, found)
         start%step = 1
         if (found) call parse_integer(word, start%step, found)
         if (start%step < 1 .or. start%step > size(model%step)) then
            call complain(model%log, 'E0106', 'the deck has no step '//to_text(start%step), at, &
               & help='STEP counts the steps of the deck from 1')
            start%step = 0
            return
         end if
         call read_time('BEGUN', start%begun)
         call read_time('TIME', start%time)
         call read_time('REST', start%rest)
         call read_time('INCREMENT', start%increment)
         call read_time('RELEASE', start%release)
         call read_time('SEATING', start%seating)
         associate (step => model%step(start%step))
            if (.not. step%nlgeom) call complain(model%log, 'E0210', &
               & 'a run goes on in the middle of a step of finite strain only', block%at, &
               & help='write *STEP, NLGEOM')
            if (start%time < 0.0_wp .or. .not. start%time < step%period) call complain( &
               & model%log, 'E0106', 'TIME='//to_text(start%time)//' is not within step '// &
               & to_text(start%step)//', which lasts '//to_text(step%period), block%at)
            if (.not. start%increment > 0.0_wp) start%increment = step%initial
            if (.not. start%rest > 0.0_wp) start%rest = start%increment
         end associate
      end associate

   contains

      subroutine read_time(name, value)
         character(len=*), intent(in) :: name
         real(wp), intent(inout) :: value

         call get_word(block, name, word, at, found)
         if (found) call parse_real(word, value, found)
      end subroutine read_time
   end subroutine read_times

   !> A line: node or set, dof, displacement, the same where the step began, load there.
   subroutine read_place(model, scene, field, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: scope
      type(displaced_type) :: new
      integer, allocatable :: node(:)
      real(wp) :: value(3)
      integer :: i, k
      logical :: found

      if (size(field) < 3) then
         call complain(model%log, 'E0103', 'a line of *START has a node, a degree of freedom '// &
            & 'and a displacement', field(1)%at)
         return
      end if
      call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
      call field_integer(field(2), new%dof, model%log, found)
      if (new%dof < 1 .or. new%dof > 6) then
         call complain(model%log, 'E0106', 'degrees of freedom are 1 to 6', field(2)%at)
         return
      end if
      value = 0.0_wp
      do k = 3, min(size(field), 5)
         if (len_trim(field(k)%text) > 0) call field_real(field(k), value(k - 2), model%log, found)
      end do
      new%now = value(1)
      new%begun = value(2)
      new%force = value(3)
      do i = 1, size(node)
         new%node = node(i)
         model%start%displaced = [model%start%displaced, new]
      end do
   end subroutine read_place

   !> Where rigid bodies stand then.
   subroutine place_bodies(model)
      type(model_type), intent(inout) :: model
      integer :: i, body

      do body = 1, size(model%rigid_body)
         do i = 1, size(model%start%displaced)
            associate (b => model%rigid_body(body), d => model%start%displaced(i))
               if (d%node == b%reference) b%start(d%dof) = d%now
               if (d%node == b%rotation .and. d%dof <= 3) b%start(d%dof + 3) = d%now
            end associate
         end do
      end do
   end subroutine place_bodies
end module lopin_build_start
