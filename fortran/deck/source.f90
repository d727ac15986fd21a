!> The files of a deck: reading one whole, cutting it into lines, finding what it includes.
module lopin_source
   use lopin_block, only : source_type
   use lopin_whole_text, only : read_whole, file_is_missing
   implicit none
   private
   public :: new_source, new_source_from_file, folder_of, find_include, shortened

   character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

contains

   !> Read a whole file; `reason` is '' when that went well.
   subroutine new_source_from_file(self, path, reason)
      type(source_type), intent(out) :: self
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: reason
      character(len=:), allocatable :: text

      call read_whole(path, text, reason)
      if (len(reason) == 0) call new_source(self, path, folder_of(path), text)
   end subroutine new_source_from_file

   subroutine new_source(self, name, folder, text)
      type(source_type), intent(out) :: self
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: folder   !! with a trailing slash, or ''
      character(len=*), intent(in) :: text
      integer :: first, i, k

      first = 1
      if (index(text, byte_order_mark) == 1) first = 4
      self%name = name
      self%folder = folder
      self%text = text(first:)
      associate (whole => self%text)
         self%nline = 0
         do i = 1, len(whole)
            if (whole(i:i) == achar(10)) self%nline = self%nline + 1
            if (iachar(whole(i:i)) > 127) self%is_ascii = .false.
         end do
         if (len(whole) > 0) then
            if (whole(len(whole):) /= achar(10)) self%nline = self%nline + 1
         end if
         allocate (self%line_start(self%nline + 1))
         self%line_start(1) = 1
         k = 1
         do i = 1, len(whole)
            if (whole(i:i) /= achar(10)) cycle
            k = k + 1
            self%line_start(k) = i + 1
         end do
         self%line_start(self%nline + 1) = len(whole) + 1
      end associate
   end subroutine new_source

   !> `a/b/c.inp` lies in `a/b/`; `c.inp` lies in ''.
   pure function folder_of(path) result(folder)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: folder
      folder = path(:scan(path, '/\', back=.true.))
   end function folder_of

   !> Where an included file is: beside the file that names it, else beside the deck.
   subroutine find_include(source, file, name, path, tried)
      type(source_type), intent(in) :: source(:)
      integer, intent(in) :: file                          !! the source with the *INCLUDE line
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(out) :: path   !! '' when it is nowhere
      character(len=:), allocatable, intent(out) :: tried  !! the paths looked at

      path = name
      tried = name
      if (name(1:1) /= '/') then
         path = shortened(source(file)%folder//name)
         tried = path
      end if
      if (.not. file_is_missing(path)) return
      path = shortened(source(1)%folder//name)
      if (name(1:1) /= '/' .and. path /= tried) then
         tried = tried//', '//path
         if (.not. file_is_missing(path)) return
      end if
      path = ''
   end subroutine find_include

   !> `a/../b/./c.inp` is `b/c.inp`, so that a file has one name.
   pure function shortened(path) result(text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: text
      integer :: first, slash, before

      text = ''
      if (index(path, '/') == 1) text = '/'
      first = 1
      do while (first <= len(path))
         slash = index(path(first:), '/')
         if (slash == 0) slash = len(path) - first + 2
         associate (part => path(first:first + slash - 2))
            before = index(text(:max(0, len(text) - 1)), '/', back=.true.)
            if (part == '..' .and. len(text) > 1 .and. text(before + 1:) /= '../') then
               text = text(:before)
            else if (len(part) > 0 .and. part /= '.') then
               text = text//part//'/'
            end if
         end associate
         first = first + slash
      end do
      text = text(:max(0, len(text) - 1))
   end function shortened
end module lopin_source
