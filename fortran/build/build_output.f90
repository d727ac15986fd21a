!> Requests for output: the cards of CalculiX (`*NODE PRINT` ...) and of Abaqus (`*OUTPUT` ...).
!>
!> `*NODE OUTPUT` and its like become file requests under `*OUTPUT, FIELD` and print requests under
!> HISTORY.
!> A step without requests of a kind goes on with those of the step before.
module lopin_build_output
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : upper, parse_integer
   use lopin_model, only : model_type, output_type, output_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, has_parameter
   use lopin_build_scene, only : scene_type, get_word, set_named
   use lopin_build_surfaces, only : surface_named
   implicit none
   private
   public :: output_of_step

contains

   subroutine output_of_step(model, deck, scene, step)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: step
      type(output_type) :: output
      type(output_type), allocatable :: list(:)
      integer :: k, i, parent, frequency, own

      allocate (list(0))
      parent = output_of%field
      frequency = 1
      do k = 1, scene%ncard
         if (scene%card(k)%step /= step) cycle
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword == 'OUTPUT') then
               parent = output_of%field
               if (has_parameter(block, 'HISTORY')) parent = output_of%history
               frequency = frequency_of(block, 1)
            end if
            output = output_type()
            output%kind = kind_of_card(block%keyword, parent)
            if (output%kind == 0) cycle
            call read_output(output, model, scene, block, scope, frequency)
            list = [list, output]
         end associate
      end do
      own = size(list)
      if (step > 1) then
         do i = 1, size(model%step(step - 1)%output)
            if (any(list(:own)%kind == model%step(step - 1)%output(i)%kind)) cycle
            list = [list, model%step(step - 1)%output(i)]
         end do
      end if
      call move_alloc(list, model%step(step)%output)
   end subroutine output_of_step

   pure integer function kind_of_card(keyword, parent) result(kind)
      character(len=*), intent(in) :: keyword
      integer, intent(in) :: parent            !! field or history

      kind = 0
      select case (keyword)
      case ('NODE PRINT')
         kind = output_of%node_print
      case ('EL PRINT')
         kind = output_of%element_print
      case ('CONTACT PRINT')
         kind = output_of%contact_print
      case ('NODE FILE')
         kind = output_of%node_file
      case ('EL FILE')
         kind = output_of%element_file
      case ('CONTACT FILE')
         kind = output_of%contact_file
      case ('OUTPUT')
         kind = parent
      case ('NODE OUTPUT')
         kind = merge(output_of%node_print, output_of%node_file, parent == output_of%history)
      case ('ELEMENT OUTPUT')
         kind = merge(output_of%element_print, output_of%element_file, parent == output_of%history)
      case ('CONTACT OUTPUT')
         kind = merge(output_of%contact_print, output_of%contact_file, parent == output_of%history)
      end select
   end function kind_of_card

   subroutine read_output(output, model, scene, block, scope, frequency)
      type(output_type), intent(inout) :: output
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      integer, intent(in) :: frequency          !! of the *OUTPUT above
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: word
      character(len=8) :: variable
      type(location_type) :: at
      integer :: j, i, n
      logical :: found

      output%at = block%at
      allocate (output%variable(0))
      output%frequency = frequency_of(block, merge(frequency, 1, &
         & index(block%keyword, ' OUTPUT') > 0))
      call get_word(block, 'NSET', word, at, found)
      if (found) output%set = set_named(scene, model%mesh%nset, 'node set', word, scope, at, &
         & model%log)
      call get_word(block, 'ELSET', word, at, found)
      if (found) output%set = set_named(scene, model%mesh%elset, 'element set', word, scope, at, &
         & model%log)
      call get_word(block, 'SLAVE', word, at, found)
      if (found) output%slave = surface_named(model, scene, word, scope, at)
      call get_word(block, 'MASTER', word, at, found)
      if (found) output%master = surface_named(model, scene, word, scope, at)
      call get_word(block, 'TOTALS', word, at, found)
      output%totals = word == 'YES' .or. word == 'ONLY'
      output%totals_only = word == 'ONLY'
      call get_word(block, 'GLOBAL', word, at, found)
      if (block%keyword == 'NODE PRINT') output%global = found .and. word /= 'NO'
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         do i = 1, n
            if (len(field(i)%text) == 0) cycle
            if (any(upper(field(i)%text) == [character(len=9) :: 'PRESELECT', 'ALL'])) cycle
            variable = upper(field(i)%text)
            if (.not. any(known_results(block%keyword) == variable)) then
               call note_missing(model%log, block%keyword, field(i))
               cycle
            end if
            output%variable = [character(len=8) :: output%variable, variable]
         end do
      end do
   end subroutine read_output

   !> Variables that a card may ask for.
   pure function known_results(keyword) result(words)
      character(len=*), intent(in) :: keyword
      character(len=8), allocatable :: words(:)

      select case (keyword)
      case ('NODE PRINT', 'NODE FILE', 'NODE OUTPUT')
         words = [character(len=8) :: 'U', 'RF']
      case ('EL PRINT', 'EL FILE', 'ELEMENT OUTPUT')
         words = [character(len=8) :: 'S', 'E', 'PEEQ', 'MISES', 'DAMAGE', 'ELSE', &
            & 'EVOL']
      case default
         words = [character(len=8) :: 'CDIS', 'COPEN', 'CDISP', 'CSTR', 'CPRESS', 'CSTRESS', &
            & 'CNUM', 'CF', 'CFORCE', 'CFN', 'CFS', 'CNORMF', 'CSTATUS']
      end select
   end function known_results

   !> Say once that a variable is left out.
   subroutine note_missing(log, keyword, field)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: keyword
      type(field_type), intent(in) :: field
      character(len=:), allocatable :: message
      integer :: i

      message = upper(field%text)//' of *'//keyword//' is no result of Lopin: left out'
      do i = 1, log%n
         if (log%item(i)%id == 'N0104' .and. log%item(i)%message == message) return
      end do
      call log%say(severity%note, 'N0104', message, field%at, &
         & help="lopin doc '*"//keyword//"'")
   end subroutine note_missing

   integer function frequency_of(block, otherwise) result(frequency)
      type(block_type), intent(in) :: block
      integer, intent(in) :: otherwise
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: found

      frequency = otherwise
      call get_word(block, 'FREQUENCY', word, at, found)
      if (.not. found) return
      call parse_integer(word, frequency, found)
      if (.not. found) frequency = otherwise
   end function frequency_of
end module lopin_build_output
