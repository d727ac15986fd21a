!> Reads decks: the grammar of Abaqus keyword files, from a file or from memory, with its *INCLUDE
!> files.
!>
!> Reading goes on after an error, so that one run shows what is wrong everywhere; the first twenty
!> errors come back together. The keyword table (`lopin_keywords`) then judges every block.
module lopin_deck
   use lopin_block, only : source_type, parameter_type, data_line_type, field_type, block_type, &
      & deck_type, split_fields, count_fields, field_real, field_integer, get_parameter, &
      & has_parameter, complain, line_text, line_place
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_checked_file, only : file_kind
   use lopin_error, only : error_type, log_type, location_type, error_code, raise, &
      & raise_all
   use lopin_keyword_line, only : begin_block, more_parameters
   use lopin_source, only : new_source_from_file, new_source, folder_of, find_include, shortened
   use lopin_text, only : quoted, to_text
   use lopin_validate, only : validate_deck
   implicit none
   private
   public :: read_deck, read_deck_text
   public :: source_type, parameter_type, data_line_type, field_type, block_type, deck_type
   public :: split_fields, count_fields, field_real, field_integer, get_parameter, has_parameter
   public :: complain, line_text, line_place

   integer, parameter :: deepest = 32      !! files included one in another
   integer, parameter :: most_files = 1000  !! of a deck
   character(len=*), parameter :: too_many = 'the deck has 1000 files'
   character(len=*), parameter :: blanks = ' '//achar(9)

contains

   !> Read a file and everything that it includes.
   subroutine read_deck(deck, path, log, error)
      type(deck_type), intent(out) :: deck
      character(len=*), intent(in) :: path
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(source_type) :: source
      character(len=:), allocatable :: reason

      call new_source_from_file(source, shortened(path), reason)
      if (len(reason) > 0) then
         call start(deck)
         call raise(error, error_code%resource, 'E0100', 'cannot read '//quoted(path)//': '// &
            & reason, help=remedy(path))
         return
      end if
      call read_source(deck, source, log, error)
   end subroutine read_deck

   !> What was meant by a path that is no deck.
   function remedy(path) result(text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: text
      integer :: kind
      integer(int64) :: length

      text = 'give the path of a deck, for example: lopin run deck.inp'
      call file_kind(path//'.inp', kind, length)
      if (kind == 0) text = 'did you mean '//path//'.inp?'
      call file_kind(path, kind, length)
      if (kind == 2) text = text//'; lopin report '//path//' shows the results in a folder'
   end function remedy

   !> Read a deck that a caller holds in memory.
   subroutine read_deck_text(deck, text, name, folder, log, error)
      type(deck_type), intent(out) :: deck
      character(len=*), intent(in) :: text
      character(len=*), intent(in) :: name     !! shown in messages instead of a path
      character(len=*), intent(in) :: folder   !! of its *INCLUDE files; '' is the current one
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(source_type) :: source

      call new_source(source, name, folder_of(trim(folder)//'/'), text)
      if (len_trim(folder) == 0) source%folder = ''
      call read_source(deck, source, log, error)
   end subroutine read_deck_text

   subroutine read_source(deck, source, log, error)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(inout) :: source   !! emptied
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      logical :: lost

      call start(deck)
      call add_source(deck, source)
      lost = .false.
      call walk(deck, 1, lost, log)
      call validate_deck(deck, log)
      call raise_all(error, error_code%deck, log)
   end subroutine read_source

   subroutine start(deck)
      type(deck_type), intent(inout) :: deck
      allocate (deck%source(0), deck%block(64))
      deck%nblock = 0
   end subroutine start

   !> Go through the lines of one source; an include is walked where it stands.
   recursive subroutine walk(deck, file, lost, log)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: file
      logical, intent(inout) :: lost          !! data before any keyword were met and reported
      type(log_type), intent(inout) :: log
      type(block_type) :: block
      integer :: line, first, last
      logical :: continued

      continued = .false.
      do line = 1, deck%source(file)%nline
         call line_span(deck%source(file), line, first, last)
         associate (text => deck%source(file)%text(first:last))
            if (is_comment_or_empty(text)) cycle
            if (continued .and. text(verify(text, blanks):verify(text, blanks)) == '*') then
               continued = .false.
               call end_keyword(deck, block, lost, log)
            end if
         end associate
         if (continued) then
            call more_parameters(block, deck%source(file)%text(first:last), file, line, continued, &
               & log)
            if (.not. continued) call end_keyword(deck, block, lost, log)
         else if (starts_with_star(deck%source(file)%text(first:last))) then
            call begin_block(block, deck%source(file)%text(first:last), file, line, continued, log)
            if (.not. continued) call end_keyword(deck, block, lost, log)
         else
            call add_line(deck, deck%source(file)%text(first:last), file, line, lost, log)
         end if
      end do
      if (continued) call end_keyword(deck, block, lost, log)
   end subroutine walk

   !> A keyword line is complete: open its block, or read the file that it includes.
   recursive subroutine end_keyword(deck, block, lost, log)
      type(deck_type), intent(inout) :: deck
      type(block_type), intent(inout) :: block
      logical, intent(inout) :: lost
      type(log_type), intent(inout) :: log

      if (block%keyword == 'INCLUDE') then
         call include(deck, block, lost, log)
      else
         call add_block(deck, block)
      end if
   end subroutine end_keyword

   recursive subroutine include(deck, block, lost, log)
      type(deck_type), intent(inout) :: deck
      type(block_type), intent(in) :: block
      logical, intent(inout) :: lost
      type(log_type), intent(inout) :: log
      type(source_type) :: source
      type(location_type) :: at
      character(len=:), allocatable :: name, path, tried, reason
      logical :: found

      call get_parameter(block, 'INPUT', name, at, found)
      if (len(name) == 0) then
         call complain(log, 'E0105', '*INCLUDE names no file', at, &
            & help='write *INCLUDE, INPUT=file.inp')
         return
      end if
      call find_include(deck%source, block%at%file, name, path, tried)
      if (len(path) == 0) then
         call complain(log, 'E0105', 'cannot read the included file '//quoted(name), at, &
            & label='not found', note='tried: '//tried)
         return
      end if
      call refuse_depth(deck, block%at%file, path, at, log, found)
      if (.not. found) return
      call new_source_from_file(source, path, reason)
      if (len(reason) > 0) then
         call complain(log, 'E0105', 'cannot read the included file '//quoted(name)//': '//reason, &
            & at)
         return
      end if
      source%included_from = block%at
      call add_source(deck, source)
      call walk(deck, size(deck%source), lost, log)
   end subroutine include

   !> Files that include themselves, too deep in one another, or too many.
   subroutine refuse_depth(deck, file, path, at, log, ok)
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: file                !! with the line *INCLUDE
      character(len=*), intent(in) :: path
      type(location_type), intent(in) :: at
      type(log_type), intent(inout) :: log
      logical, intent(out) :: ok
      integer :: k, depth

      ok = .false.
      depth = 0
      k = file
      do while (k > 0)
         depth = depth + 1
         if (deck%source(k)%name == path) then
            call complain(log, 'E0105', 'the file '//quoted(path)//' includes itself', at, &
               & label='include loop')
            return
         end if
         k = deck%source(k)%included_from%file
      end do
      ok = depth <= deepest .and. size(deck%source) < most_files
      if (depth > deepest) then
         call complain(log, 'E0105', 'files are included '//to_text(depth)//' deep', at, &
            & help='at most '//to_text(deepest)//' may stand in one another')
      else if (.not. ok .and. .not. log_has(log, too_many)) then
         call complain(log, 'E0105', too_many//', the most that are read', at, &
            & help='a file that includes another one twice, and so on, soon has more')
      end if
   contains
      logical function log_has(log, start_of_message)
         type(log_type), intent(in) :: log
         character(len=*), intent(in) :: start_of_message
         integer :: i

         log_has = .false.
         do i = 1, log%n
            log_has = log_has .or. index(log%item(i)%message, start_of_message) == 1
         end do
      end function log_has
   end subroutine refuse_depth

   !> Append a data line to the last block.
   subroutine add_line(deck, text, file, line, lost, log)
      type(deck_type), intent(inout) :: deck
      character(len=*), intent(in) :: text
      integer, intent(in) :: file, line
      logical, intent(inout) :: lost
      type(log_type), intent(inout) :: log
      type(data_line_type) :: data

      if (deck%nblock == 0) then
         data = data_line_type(file, line, text)
         if (.not. lost) call complain(log, 'E0110', 'data before any keyword', line_place(data), &
            & label='which keyword does this line belong to?', &
            & help='a deck begins with a keyword line, for example *HEADING or *NODE')
         lost = .true.
         return
      end if
      associate (block => deck%block(deck%nblock))
         if (block%nline == size(block%line)) call grow_lines(block%line)
         block%nline = block%nline + 1
         block%line(block%nline)%file = file
         block%line(block%nline)%line = line
         block%line(block%nline)%text = text
      end associate
   end subroutine add_line

   subroutine grow_lines(line)
      type(data_line_type), allocatable, intent(inout) :: line(:)
      type(data_line_type), allocatable :: grown(:)
      integer :: i

      allocate (grown(max(8, 4*size(line))))
      do i = 1, size(line)
         grown(i)%file = line(i)%file
         grown(i)%line = line(i)%line
         call move_alloc(line(i)%text, grown(i)%text)
      end do
      call move_alloc(grown, line)
   end subroutine grow_lines

   subroutine add_block(deck, block)
      type(deck_type), intent(inout) :: deck
      type(block_type), intent(inout) :: block   !! emptied
      type(block_type), allocatable :: grown(:)
      integer :: i

      if (deck%nblock == size(deck%block)) then
         allocate (grown(2*deck%nblock))
         do i = 1, deck%nblock
            call move_block(deck%block(i), grown(i))
         end do
         call move_alloc(grown, deck%block)
      end if
      deck%nblock = deck%nblock + 1
      call move_block(block, deck%block(deck%nblock))
   end subroutine add_block

   subroutine move_block(from, to)
      type(block_type), intent(inout) :: from, to

      call move_alloc(from%keyword, to%keyword)
      call move_alloc(from%parameter, to%parameter)
      call move_alloc(from%line, to%line)
      to%at = from%at
      to%nline = from%nline
   end subroutine move_block

   subroutine add_source(deck, source)
      type(deck_type), intent(inout) :: deck
      type(source_type), intent(inout) :: source   !! emptied
      type(source_type), allocatable :: grown(:)
      integer :: i

      allocate (grown(size(deck%source) + 1))
      do i = 1, size(deck%source)
         call move_source(deck%source(i), grown(i))
      end do
      call move_source(source, grown(size(grown)))
      call move_alloc(grown, deck%source)
   end subroutine add_source

   subroutine move_source(from, to)
      type(source_type), intent(inout) :: from, to

      to%nline = from%nline
      to%is_ascii = from%is_ascii
      to%included_from = from%included_from
      call move_alloc(from%name, to%name)
      call move_alloc(from%folder, to%folder)
      call move_alloc(from%text, to%text)
      call move_alloc(from%line_start, to%line_start)
   end subroutine move_source

   !> First and last character of a line within the text of its source, without its end.
   pure subroutine line_span(source, line, first, last)
      type(source_type), intent(in) :: source
      integer, intent(in) :: line
      integer, intent(out) :: first, last

      first = source%line_start(line)
      last = source%line_start(line + 1) - 1
      if (last >= first) then
         if (source%text(last:last) == achar(10)) last = last - 1
      end if
      if (last >= first) then
         if (source%text(last:last) == achar(13)) last = last - 1
      end if
   end subroutine line_span

   pure logical function is_comment_or_empty(text) result(skip)
      character(len=*), intent(in) :: text
      integer :: first

      first = verify(text, blanks)
      skip = first == 0
      if (skip .or. first >= len(text)) return
      skip = text(first:first + 1) == '**'
   end function is_comment_or_empty

   pure logical function starts_with_star(text)
      character(len=*), intent(in) :: text
      integer :: first

      first = verify(text, blanks)
      starts_with_star = text(first:first) == '*'
   end function starts_with_star
end module lopin_deck
