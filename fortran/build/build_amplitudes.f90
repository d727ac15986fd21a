!> `*AMPLITUDE` cards, and the value that an amplitude leaves when its step is over.
module lopin_build_amplitudes
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, amplitude_type, amplitude_value
   use lopin_block, only : deck_type, block_type, field_type, split_fields, complain
   use lopin_build_scene, only : need_real, scene_type, name_type, need_word, get_word, &
      & find_name, no_such
   implicit none
   private
   public :: build_amplitudes, read_amplitude_word, hold_value

contains

   subroutine build_amplitudes(model, deck, scene, absolute)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      logical, allocatable, intent(out) :: absolute(:)   !! VALUE=ABSOLUTE: points are the load
      type(amplitude_type) :: amplitude
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k, i
      logical :: found

      allocate (model%amplitude(0), absolute(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'AMPLITUDE') cycle
            amplitude = amplitude_type()
            call need_word(block, 'NAME', amplitude%name, at, found, model%log)
            if (.not. found) cycle
            do i = 1, size(model%amplitude)
               if (model%amplitude(i)%name == amplitude%name) call complain(model%log, 'E0205', &
                  & 'amplitude `' &
                  & //amplitude%name//'` is defined twice', at)
            end do
            call get_word(block, 'TIME', word, at, found)
            amplitude%total_time = word == 'TOTAL TIME'
            call get_word(block, 'VALUE', word, at, found)
            absolute = [absolute, word == 'ABSOLUTE']
            call read_points(amplitude, block, model%log)
            model%amplitude = [model%amplitude, amplitude]
         end associate
      end do
   end subroutine build_amplitudes

   !> Pairs of time and value, several on a line.
   subroutine read_points(amplitude, block, log)
      type(amplitude_type), intent(inout) :: amplitude
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      type(location_type) :: at
      real(wp), allocatable :: pair(:)
      real(wp) :: value
      integer :: j, i, n
      logical :: found

      allocate (pair(0))
      at = block%at
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         do i = 1, n
            call need_real(field(i), value, log, found)
            pair = [pair, value]
            if (mod(size(pair), 2) == 1 .and. size(pair) > 1) then
               if (found .and. .not. value > pair(size(pair) - 2)) then
                  call complain(log, 'E0406', 'time '//to_text(value, 6)//' of amplitude `' &
                     & //amplitude%name &
                     & //'` does not come after '//to_text(pair(size(pair) - 2), 6), field(i)%at)
                  found = .false.
               end if
               if (.not. found) exit
            end if
            at = field(i)%at
         end do
      end do
      if (size(pair) == 0 .or. mod(size(pair), 2) == 1) then
         if (log%count_of(severity%error) == 0) call complain(log, 'E0406', 'amplitude `' &
            & //amplitude%name &
            & //'` needs pairs of time and value; '//to_text(size(pair))//' numbers given', at)
         pair = [0.0_wp, 1.0_wp]
      end if
      amplitude%time = pair(1::2)
      amplitude%value = pair(2::2)
   end subroutine read_points

   !> The amplitude that a card names; 0 without one or after a complaint.
   integer function read_amplitude_word(model, block) result(k)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      type(name_type) :: names(size(model%amplitude))
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: i
      logical :: found

      k = 0
      call get_word(block, 'AMPLITUDE', word, at, found)
      if (.not. found) return
      do i = 1, size(names)
         names(i)%text = model%amplitude(i)%name
      end do
      k = find_name(names, word)
      if (k == 0) call no_such(model%log, 'amplitude', word, names, at)
   end function read_amplitude_word

   !> A load that goes on into the next step keeps the value it had at the end; total time runs on.
   elemental subroutine hold_value(model, period, amplitude, value)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: period            !! of the step that ends [time]
      integer, intent(inout) :: amplitude
      real(wp), intent(inout) :: value

      if (amplitude == 0) return
      if (model%amplitude(amplitude)%total_time) return
      value = value*amplitude_value(model%amplitude(amplitude), period)
      amplitude = 0
   end subroutine hold_value
end module lopin_build_amplitudes
